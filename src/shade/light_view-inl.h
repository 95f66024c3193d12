// Points in a light's view, one in each lane. Compiled once for each CPU target.

#if defined(PENTAPRISM_SHADE_LIGHT_VIEW_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_SHADE_LIGHT_VIEW_INL_H
#undef PENTAPRISM_SHADE_LIGHT_VIEW_INL_H
#else
#define PENTAPRISM_SHADE_LIGHT_VIEW_INL_H
#endif

#include "cover/lanes-inl.h"
#include "shade/casters.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

struct PlacedPoints {
    Vec x, y, z;
};

// LightView::place() of points[at].
HWY_INLINE PlacedPoints placed(F f, const LightView& view, std::span<const glm::vec3> points, hn::Vec<I> at) {
    const hn::Vec<I> first = hn::Add(hn::Add(at, at), at);
    Vec p[3];
    for (int axis = 0; axis < 3; ++axis)
        p[axis] = hn::Sub(hn::GatherIndex(f, &points[0][axis], first), hn::Set(f, view.position[axis]));
    const auto along = [&](const glm::vec3& axis) HWY_ATTR {
        const Vec xy = hn::Add(hn::Mul(p[0], hn::Set(f, axis.x)), hn::Mul(p[1], hn::Set(f, axis.y)));
        return hn::Add(xy, hn::Mul(p[2], hn::Set(f, axis.z)));
    };
    return {along(view.axes[0]), along(view.axes[1]), along(view.axes[2])};
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
