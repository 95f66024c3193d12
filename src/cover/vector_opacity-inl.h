// Alpha masks and stochastic transparency of a vector of hits: the arithmetic of is_opaque_at() (frame/opacity.h), lane
// by lane the same roundings in the same order.

#if defined(PENTAPRISM_COVER_VECTOR_OPACITY_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_COVER_VECTOR_OPACITY_INL_H
#undef PENTAPRISM_COVER_VECTOR_OPACITY_INL_H
#else
#define PENTAPRISM_COVER_VECTOR_OPACITY_INL_H
#endif

#include <algorithm>
#include <bit>

#include "base/bytes_at-inl.h"
#include "cover/lanes-inl.h"
#include "frame/opacity.h"
#include "sample/net.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

using IntVec = hn::Vec<I>;

HWY_INLINE Vec mixed(F f, const Vec b[3], float p, float q, float r) {
    return hn::Add(hn::Add(hn::Mul(b[0], hn::Set(f, p)), hn::Mul(b[1], hn::Set(f, q))), hn::Mul(b[2], hn::Set(f, r)));
}

// A texture coordinate in one period, times the size: what Pyramid::alpha() makes of it. At most 2 * size.
HWY_INLINE Vec to_texels(F f, Wrap wrap, Vec x, int size) {
    const Vec zero = hn::Zero(f), n = hn::Set(f, static_cast<float>(size));
    if (wrap == Wrap::kClampToEdge) {
        const Vec clamped = hn::IfThenElse(hn::Gt(x, zero), hn::Min(x, hn::Set(f, 1.0f)), zero);
        return hn::Mul(clamped, n);
    }
    const Mask usable = hn::Lt(hn::Abs(x), hn::Set(f, 0x1p23f));
    const Vec period =
        wrap == Wrap::kRepeat ? hn::Floor(x) : hn::Mul(hn::Set(f, 2.0f), hn::Floor(hn::Mul(hn::Set(f, 0.5f), x)));
    return hn::Mul(hn::IfThenElseZero(usable, hn::Sub(x, period)), n);
}

// Texel that a position at most one period off stands for.
HWY_INLINE IntVec wrapped(I i, Wrap wrap, IntVec texel, int size) {
    const IntVec zero = hn::Zero(i), last = hn::Set(i, size - 1);
    if (wrap == Wrap::kClampToEdge) return hn::Min(hn::Max(texel, zero), last);
    const IntVec period = hn::Set(i, wrap == Wrap::kRepeat ? size : 2 * size);
    texel = hn::IfThenElse(hn::Lt(texel, zero), hn::Add(texel, period), texel);
    texel = hn::IfThenElse(hn::Lt(texel, period), texel, hn::Sub(texel, period));
    if (wrap == Wrap::kRepeat) return texel;
    return hn::IfThenElse(hn::Gt(texel, last), hn::Sub(hn::Set(i, 2 * size - 1), texel), texel);
}

HWY_INLINE Vec texture_alpha(F f, const OpacityTerms& terms, Vec s, Vec t, Mask hit) {
    const I i;
    const TextureRef& ref = *terms.ref;
    const int width = terms.texture->width(), height = terms.texture->height();
    const std::uint8_t* codes = terms.texture->opacity_codes();
    Vec x = to_texels(f, ref.wrap_s, s, width), y = to_texels(f, ref.wrap_t, t, height);
    if (!ref.nearest) {
        x = hn::Sub(x, hn::Set(f, 0.5f));
        y = hn::Sub(y, hn::Set(f, 0.5f));
    }
    const Vec x_floor = hn::Floor(x), y_floor = hn::Floor(y);
    const IntVec one = hn::Set(i, 1), row = hn::Set(i, width);
    const IntVec column0 = hn::ConvertTo(i, x_floor), row0 = hn::ConvertTo(i, y_floor);
    const IntVec left = wrapped(i, ref.wrap_s, column0, width);
    const IntVec upper = hn::Mul(wrapped(i, ref.wrap_t, row0, height), row);
    const auto inside = hn::RebindMask(i, hit);
    // A texel's code and those to its right (Pyramid::kBeyondCodes). Other lanes may lie anywhere.
    const auto codes_from = [&](IntVec texel)
                                HWY_ATTR { return bytes_at(i, codes, hn::IfThenElseZero(inside, texel)); };
    const auto code = [&](IntVec word) HWY_ATTR { return hn::ConvertTo(f, hn::And(word, hn::Set(i, 0xff))); };
    const IntVec upper_left = codes_from(hn::Add(upper, left));
    if (ref.nearest) return hn::Mul(code(upper_left), hn::Set(f, 1.0f / 255.0f));
    const IntVec right = wrapped(i, ref.wrap_s, hn::Add(column0, one), width);
    const IntVec lower = hn::Mul(wrapped(i, ref.wrap_t, hn::Add(row0, one), height), row);
    const IntVec lower_left = codes_from(hn::Add(lower, left));
    IntVec upper_right = hn::ShiftRight<8>(upper_left), lower_right = hn::ShiftRight<8>(lower_left);
    if (!hn::AllFalse(i, hn::And(inside, hn::Ne(right, hn::Add(left, one))))) {
        upper_right = codes_from(hn::Add(upper, right));
        lower_right = codes_from(hn::Add(lower, right));
    }
    const Vec share_x = hn::Sub(x, x_floor), share_y = hn::Sub(y, y_floor);
    const auto between = [&](Vec p, Vec q, Vec share) HWY_ATTR { return hn::Add(p, hn::Mul(hn::Sub(q, p), share)); };
    const Vec above = between(code(upper_left), code(upper_right), share_x);
    const Vec below = between(code(lower_left), code(lower_right), share_x);
    return hn::Mul(between(above, below, share_y), hn::Set(f, 1.0f / 255.0f));
}

using Words = hn::Vec<U>;

// mix() and permuted() of frame/opacity.cpp, step by step; there is who they are by.
HWY_INLINE Words mixed_bits(U u, Words x) {
    x = hn::Mul(hn::Xor(x, hn::ShiftRight<16>(x)), hn::Set(u, 0x7feb352du));
    x = hn::Mul(hn::Xor(x, hn::ShiftRight<15>(x)), hn::Set(u, 0x846ca68bu));
    return hn::Xor(x, hn::ShiftRight<16>(x));
}

HWY_INLINE Words permuted_once(U u, Words i, Words mask, Words seed) {
    i = hn::And(hn::Add(i, seed), mask);
    i = hn::Xor(i, hn::And(hn::ShiftRight<16>(seed), mask));
    i = hn::Mul(i, hn::Set(u, 0xe170893du));
    i = hn::And(hn::Xor(i, hn::ShiftRight<8>(seed)), mask);
    i = hn::Xor(i, hn::ShiftRight<4>(i));
    const Words factor = hn::Xor(hn::Set(u, 0x0929eb3fu), hn::ShiftLeft<1>(hn::ShiftRight<23>(seed)));
    i = hn::And(hn::Mul(i, factor), mask);
    i = hn::Xor(i, hn::ShiftRight<1>(i));
    i = hn::And(hn::Mul(i, hn::Set(u, 0x6935fa69u)), mask);
    i = hn::Xor(i, hn::ShiftRight<11>(i));
    i = hn::And(hn::Mul(i, hn::Set(u, 0x74dcb303u)), mask);
    i = hn::Xor(i, hn::ShiftRight<2>(i));
    i = hn::And(hn::Mul(i, hn::Set(u, 0x9e501cc3u)), mask);
    return hn::Xor(i, hn::ShiftRight<2>(i));
}

HWY_INLINE Words permuted(U u, Words i, std::uint32_t n, Words seed) {
    const I as_signed;  // numbers are small
    const Words mask = hn::Set(u, std::bit_ceil(n) - 1);
    const auto outside = [&](Words x) HWY_ATTR {
        return hn::RebindMask(u, hn::Gt(hn::BitCast(as_signed, x), hn::Set(as_signed, static_cast<int>(n) - 1)));
    };
    i = permuted_once(u, i, mask, seed);
    for (auto again = outside(i); !hn::AllFalse(u, again); again = outside(i))
        i = hn::IfThenElse(again, permuted_once(u, i, mask, seed), i);
    return i;
}

HWY_INLINE Words permuted_digits(U u, Words digit, Words random) {
    const Words g = hn::ShiftRight<16>(hn::Mul(hn::ShiftRight<16>(random), hn::Set(u, 3u)));
    const Words at = hn::Add(hn::ShiftLeft<3>(g), hn::Add(digit, digit)), three = hn::Set(u, 3u);
    return hn::Xor(hn::And(hn::Shr(hn::Set(u, 0x9c78e4u), at), three), hn::And(random, three));
}

// random_net() of frame/opacity.cpp.
HWY_INLINE Words random_net(U u, Words place, int spp_bits, int bits, Words seed) {
    Words result = hn::Zero(u);
    for (int done = 0; done < bits;) {
        const int width = done + 1 == spp_bits || done + 1 == bits ? 1 : 2;
        const Words digit = hn::ShiftRightSame(place, done), before = hn::ShiftRightSame(digit, width);
        const Words known = hn::Or(hn::ShiftLeftSame(before, done), result);
        const Words random =
            mixed_bits(u, hn::Add(hn::Add(seed, hn::Set(u, static_cast<std::uint32_t>(done) << 16)), known));
        result = width == 2
                     ? hn::Or(hn::ShiftLeft<2>(result), permuted_digits(u, hn::And(digit, hn::Set(u, 3u)), random))
                     : hn::Or(hn::ShiftLeft<1>(result), hn::And(hn::Xor(digit, random), hn::Set(u, 1u)));
        done += width;
    }
    return result;
}

// As frame/opacity.cpp has it: the b << i of bits of a that are set.
HWY_INLINE Words product16(U u, Words a, Words b) {
    const Words zero = hn::Zero(u);
    Words sum = zero;
    for (int i = 0; i < 4; ++i) {
        const Words bit = hn::And(a, hn::Set(u, 1u << i));
        sum = hn::Xor(sum, hn::IfThenZeroElse(hn::Eq(bit, zero), hn::ShiftLeftSame(b, i)));
    }
    const Words over = hn::ShiftRight<4>(sum);
    return hn::Xor(hn::And(sum, hn::Set(u, 15u)), hn::Xor(over, hn::ShiftLeft<1>(over)));
}

// threshold_over_time() of frame/opacity.cpp.
HWY_INLINE Vec thresholds_over_time(F f, std::uint32_t surface, Words px, Words py, Words index, int spp) {
    const U u;
    const int spp_bits = std::bit_width(static_cast<unsigned>(spp) - 1u), bits = std::max(spp_bits, 4);
    const Words column = mixed_bits(u, hn::ShiftRight<2>(px));
    const Words row = mixed_bits(u, hn::Add(column, hn::ShiftRight<2>(py)));
    const Words block = mixed_bits(u, hn::Add(row, hn::Set(u, surface)));
    const Words one = hn::Set(u, 1u), two = hn::Set(u, 2u);
    const Words low = hn::Or(hn::And(px, one), hn::ShiftLeft<1>(hn::And(py, one)));
    const Words lane = hn::Or(low, hn::Or(hn::ShiftLeft<1>(hn::And(px, two)), hn::ShiftLeft<2>(hn::And(py, two))));
    const Words factor = hn::Add(one, hn::ShiftRight<16>(hn::Mul(hn::ShiftRight<16>(block), hn::Set(u, 15u))));
    const Words place = hn::Xor(index, product16(u, factor, lane));
    const Words stratum = random_net(u, place, spp_bits, bits, block);
    const Words number = hn::Add(one, hn::Or(hn::ShiftLeft<4>(index), lane));
    const Words random = mixed_bits(u, hn::Add(block, hn::Mul(number, hn::Set(u, 0x9e3779b9u))));
    const Words sum = hn::Or(hn::ShiftLeftSame(stratum, 32 - bits), hn::ShiftRightSame(random, bits));
    return hn::Mul(hn::ConvertTo(f, hn::BitCast(I(), hn::ShiftRight<8>(sum))), hn::Set(f, 0x1p-24f));
}

// opacity_threshold() of frame/opacity.h in lanes.
HWY_INLINE Vec opacity_thresholds(F f, std::uint32_t triangle, Words px, Words py, Words index,
                                  const OpacityPattern& pattern) {
    const U u;
    const std::uint32_t surface = mix(triangle + 0x9e3779b9u) + mix(pattern.seed);
    if (pattern.over_time) return thresholds_over_time(f, surface, px, py, index, pattern.spp);
    const auto to_float = [&](Words x) HWY_ATTR { return hn::ConvertTo(f, hn::BitCast(I(), x)); };
    const Words pixel = mixed_bits(u, hn::Add(mixed_bits(u, px), py));
    const auto spp = static_cast<std::uint32_t>(pattern.spp);
    const Words seed = mixed_bits(u, hn::Add(pixel, hn::Set(u, surface)));
    const Words random = mixed_bits(u, hn::Add(seed, hn::Add(index, hn::Set(u, 1u))));
    const Vec offset = hn::Mul(to_float(hn::ShiftRight<8>(random)), hn::Set(f, 0x1p-24f));
    const Vec place = hn::Add(to_float(permuted(u, index, spp, seed)), offset);
    return hn::Min(hn::Div(place, hn::Set(f, static_cast<float>(spp))), hn::Set(f, 1.0f - 0x1p-24f));
}

// Which sample of the picture stands in a lane. Functions below take it from `sample_of(k)`, k: the lane of the Vec.
struct SampleOfPixel {
    int px, py, index;
};

// Of the lanes in `ask`, those of a blended surface that are there.
template <class SampleOf>
HWY_NOINLINE Mask exceeds_threshold(F f, const TileWork& work, std::uint32_t triangle, Vec alpha, Mask ask,
                                    const SampleOf& sample_of) {
    // Thresholds are in [0, 1): 0 and 1 need no asking.
    const Mask some = hn::Gt(alpha, hn::Zero(f)), open = hn::And(some, hn::Lt(alpha, hn::Set(f, 1.0f)));
    if (hn::AllFalse(f, hn::And(ask, open))) return hn::And(ask, some);
    const U u;
    HWY_ALIGN std::uint32_t px[kLanes], py[kLanes], index[kLanes];
    for (int k = 0; k < kWidth; ++k) {
        const SampleOfPixel s = sample_of(k);
        px[k] = static_cast<std::uint32_t>(s.px);
        py[k] = static_cast<std::uint32_t>(s.py);
        index[k] = static_cast<std::uint32_t>(s.index);
    }
    const Vec threshold =
        opacity_thresholds(f, triangle, hn::Load(u, px), hn::Load(u, py), hn::Load(u, index), work.samples);
    return hn::And(ask, hn::Gt(alpha, threshold));
}

// Glass is rare: lane by lane.
template <class SampleOf>
HWY_NOINLINE Mask decide_glass(F f, const TileWork& work, std::uint32_t triangle, const Vec b[3], Mask hit,
                               const SampleOf& sample_of) {
    HWY_ALIGN float barycentrics[3][kLanes];
    HWY_ALIGN float there[kLanes] = {};
    for (int i = 0; i < 3; ++i) hn::Store(b[i], f, barycentrics[i]);
    for (std::uint64_t m = bits_of(f, hit); m != 0; m &= m - 1) {
        const int k = std::countr_zero(m);
        const float at[3] = {barycentrics[0][k], barycentrics[1][k], barycentrics[2][k]};
        const SampleOfPixel s = sample_of(k);
        there[k] = is_opaque_at(work.frame, triangle, at, s.px, s.py, s.index, work.samples) ? 1 : 0;
    }
    return hn::And(hit, hn::Gt(hn::Load(f, there), hn::Zero(f)));
}

// The lanes of `hit` whose surface is really there. `edges`, `sum`: barycentric coordinates times their sum.
template <class SampleOf>
HWY_NOINLINE Mask decide_opacity(F f, const TileWork& work, std::uint32_t triangle, const OpacityTerms& terms,
                                 const Vec edges[3], Vec sum, Mask hit, const SampleOf& sample_of) {
    const Vec b[3] = {hn::Div(edges[0], sum), hn::Div(edges[1], sum), hn::Div(edges[2], sum)};
    if (terms.glass) return decide_glass(f, work, triangle, b, hit, sample_of);
    Vec alpha = hn::Set(f, terms.factor);
    if (terms.colored) alpha = hn::Mul(alpha, mixed(f, b, terms.color[0], terms.color[1], terms.color[2]));
    if (terms.texture == nullptr) {
        alpha = hn::Mul(alpha, hn::Set(f, terms.texture_alpha));
    } else {
        Vec s = mixed(f, b, terms.uv[0].x, terms.uv[1].x, terms.uv[2].x);
        Vec t = mixed(f, b, terms.uv[0].y, terms.uv[1].y, terms.uv[2].y);
        const TextureRef& ref = *terms.ref;
        const Vec offset_s = hn::Set(f, ref.offset.x), offset_t = hn::Set(f, ref.offset.y);
        if (ref.rotation == 0.0f) {
            s = hn::Add(hn::Mul(hn::Set(f, ref.scale.x), s), offset_s);
            t = hn::Add(hn::Mul(hn::Set(f, ref.scale.y), t), offset_t);
        } else {
            const glm::vec4 m = uv_matrix(ref);
            const Vec s_turned = hn::Add(hn::Mul(hn::Set(f, m.x), s), hn::Mul(hn::Set(f, m.z), t));
            const Vec t_turned = hn::Add(hn::Mul(hn::Set(f, m.y), s), hn::Mul(hn::Set(f, m.w), t));
            s = hn::Add(s_turned, offset_s);
            t = hn::Add(t_turned, offset_t);
        }
        alpha = hn::Mul(alpha, texture_alpha(f, terms, s, t, hit));
    }
    if (terms.mode == AlphaMode::kMask) return hn::And(hit, hn::Ge(alpha, hn::Set(f, terms.cutoff)));
    return exceeds_threshold(f, work, triangle, alpha, hit, sample_of);
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
