// Shear to the middle of a cell with triangles in the lanes: the arithmetic of localize(), bit for bit, in double and
// rounded once. Compiled once for each CPU target.

#if defined(PENTAPRISM_COVER_SHEAR_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_COVER_SHEAR_INL_H
#undef PENTAPRISM_COVER_SHEAR_INL_H
#else
#define PENTAPRISM_COVER_SHEAR_INL_H
#endif

#include <cmath>

#include "cover/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

// `compute` for both halves of the lanes of floats, widened to double; the result rounded to float.
template <class Compute, class... Vecs>
HWY_INLINE Vec in_double(F f, Compute compute, Vecs... v) {
    const hn::Repartition<double, F> d;
    const hn::Rebind<float, decltype(d)> half;
    const auto lower = hn::DemoteTo(half, compute(d, hn::PromoteTo(d, hn::LowerHalf(half, v))...));
    const auto upper = hn::DemoteTo(half, compute(d, hn::PromoteTo(d, hn::UpperHalf(half, v))...));
    return hn::Combine(f, upper, lower);
}

// x - centre * w.
HWY_INLINE Vec sheared(F f, Vec x, Vec w, float centre) {
    return in_double(
        f,
        [centre](auto d, auto x_half, auto w_half)
            HWY_ATTR { return hn::Sub(x_half, hn::Mul(hn::Set(d, static_cast<double>(centre)), w_half)); },
        x, w);
}

// v[1] - v[0].
HWY_INLINE Vec change(F f, const Vec v[2]) {
    return in_double(
        f, [](auto, auto from, auto to) HWY_ATTR { return hn::Sub(to, from); }, v[0], v[1]);
}

// The change of x less centre times that of w.
HWY_INLINE Vec sheared_change(F f, const Vec x[2], const Vec w[2], float centre) {
    return in_double(
        f,
        [centre](auto d, auto x0, auto x1, auto w0, auto w1) HWY_ATTR {
            return hn::Sub(hn::Sub(x1, x0), hn::Mul(hn::Set(d, static_cast<double>(centre)), hn::Sub(w1, w0)));
        },
        x[0], x[1], w[0], w[1]);
}

// The least float that is no smaller.
inline float rounded_up(double value) {
    const float rounded = static_cast<float>(value);
    return rounded < value ? std::nextafter(rounded, INFINITY) : rounded;
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
