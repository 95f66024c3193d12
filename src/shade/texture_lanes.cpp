// Compiled once for each CPU target; the operations of footprint.cpp and scene/texture.cpp in the same order, none of
// them fused.
//
// Points have one to sixteen taps along the longer axis of their ellipse. The taps of all points are listed, and looked
// up sixteen at a time.

#include "shade/texture_lanes.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/texture_lanes.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <algorithm>
#include <cmath>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
constexpr int kAll = PointBatch::kLanes;
using F = hn::CappedTag<float, kAll>;
using I = hn::RebindToSigned<F>;
using Vec = hn::Vec<F>;
using IVec = hn::Vec<I>;
using Mask = hn::Mask<F>;
using Lanes = PointBatch::Lanes;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(F()));
constexpr float kMostTaps = 16.0f;
constexpr int kMostJobs = kAll * static_cast<int>(kMostTaps);

// Ellipses of points, as taps along their longer axes.
struct Ellipses {
    alignas(64) Lanes u, v, step_u, step_v, minor, taps;
};

HWY_INLINE Vec larger(Vec a, Vec b) {
    return hn::IfThenElse(hn::Lt(a, b), b, a);
}
HWY_INLINE Vec box_width(F f, Vec variance) {
    return hn::Sqrt(hn::Mul(hn::Set(f, 12.0f), larger(hn::Zero(f), variance)));
}

// As BoundTexture::sample() finds them. taps: 0 where the footprint is not finite.
HWY_INLINE void find_ellipses(const TextureLanes& work, int first, Ellipses& out) {
    const F f;
    const BoundTexture& texture = *work.texture;
    const Lanes* uv = work.batch->uv[texture.set];
    const Lanes* footprint = work.batch->footprint[texture.set];
    const Vec u = hn::Load(f, uv[0] + first), v = hn::Load(f, uv[1] + first);
    const auto set = [&](float x) HWY_ATTR { return hn::Set(f, x); };
    const auto place = [&](float by_u, float by_v, float offset) HWY_ATTR {
        return hn::Add(hn::Add(hn::Mul(set(by_u), u), hn::Mul(set(by_v), v)), set(offset));
    };
    const glm::vec4& m = texture.matrix;
    hn::Store(place(m.x, m.z, texture.ref.offset.x), f, out.u + first);
    hn::Store(place(m.y, m.w, texture.ref.offset.y), f, out.v + first);

    const float width = static_cast<float>(texture.pyramid->width());
    const float height = static_cast<float>(texture.pyramid->height());
    const float a = m.x * width, b = m.z * width, c = m.y * height, d = m.w * height;
    const Vec uu = hn::Load(f, footprint[0] + first), cross = hn::Load(f, footprint[1] + first),
              vv = hn::Load(f, footprint[2] + first);
    const auto form = [&](float by_uu, float by_cross, float by_vv) HWY_ATTR {
        return hn::Add(hn::Add(hn::Mul(set(by_uu), uu), hn::Mul(set(by_cross), cross)), hn::Mul(set(by_vv), vv));
    };
    const Vec xx = form(a * a, 2.0f * a * b, b * b), yy = form(c * c, 2.0f * c * d, d * d);
    const Vec xy = form(a * c, a * d + b * c, b * d);
    const Vec half_of = set(0.5f), zero = hn::Zero(f);
    const Vec mean = hn::Mul(half_of, hn::Add(xx, yy)), half = hn::Mul(half_of, hn::Sub(xx, yy));
    const Vec spread = hn::Sqrt(hn::Add(hn::Mul(half, half), hn::Mul(xy, xy)));
    const Mask finite = hn::IsFinite(hn::Add(mean, spread));

    Vec major = box_width(f, hn::Add(mean, spread));
    const Vec narrow = box_width(f, hn::Sub(mean, spread));
    const Vec minor = larger(larger(narrow, hn::Div(major, set(kMostTaps))), set(1.0f));
    major = larger(major, minor);
    const Vec wanted = hn::Ceil(hn::Sub(hn::Div(major, minor), set(0.25f)));
    Vec taps = hn::IfThenElse(hn::Lt(wanted, set(kMostTaps)), wanted, set(kMostTaps));

    const Mask wide = hn::Ge(half, zero);
    const Vec axis_x = hn::IfThenElse(wide, hn::Add(half, spread), xy);
    const Vec axis_y = hn::IfThenElse(wide, xy, hn::Sub(spread, half));
    const Vec length = hn::Sqrt(hn::Add(hn::Mul(axis_x, axis_x), hn::Mul(axis_y, axis_y)));
    const Mask several = hn::And(hn::And(finite, hn::Gt(taps, set(1.0f))), hn::Gt(length, zero));
    taps = hn::IfThenElse(several, taps, set(1.0f));
    const Vec scale = hn::Div(major, hn::Mul(length, taps));
    const auto step = [&](Vec axis, float size)
                          HWY_ATTR { return hn::IfThenElseZero(several, hn::Div(hn::Mul(axis, scale), set(size))); };
    hn::Store(step(axis_x, width), f, out.step_u + first);
    hn::Store(step(axis_y, height), f, out.step_v + first);
    hn::Store(hn::IfThenElse(finite, minor, set(1.0f)), f, out.minor + first);
    hn::Store(taps, f, out.taps + first);
}

// A level of the pyramid for each tap.
struct LevelJobs {
    alignas(64) std::int32_t width[kMostJobs], height[kMostJobs], first[kMostJobs];
};

// Taps, each with the two levels between which it lies; share: of the coarser one.
struct Jobs {
    int count = 0;
    alignas(64) float u[kMostJobs], v[kMostJobs], share[kMostJobs];
    LevelJobs fine, coarse;
    void add_level(const Pyramid& pyramid, int level, LevelJobs& out) const {
        out.width[count] = pyramid.width(level);
        out.height[count] = pyramid.height(level);
        out.first[count] = static_cast<std::int32_t>(pyramid.first_texel(level));
    }
};

void list_jobs(const TextureLanes& work, const Ellipses& ellipses, Jobs& jobs) {
    const Pyramid& pyramid = *work.texture->pyramid;
    const float coarsest = static_cast<float>(pyramid.level_count() - 1);
    for (int lane = 0; lane < work.batch->count; ++lane) {
        // As Pyramid::sample() does.
        const float minor = ellipses.minor[lane], level = minor > 1.0f ? std::log2(minor) : 0.0f;
        const int fine = static_cast<int>(std::min(level, coarsest));
        const float share = level < coarsest ? level - static_cast<float>(fine) : 0.0f;
        const int coarse = share > 0.0f ? fine + 1 : fine, taps = static_cast<int>(ellipses.taps[lane]);
        for (int i = 0; i < taps; ++i, ++jobs.count) {
            const float along = static_cast<float>(i) - 0.5f * static_cast<float>(taps - 1);
            jobs.u[jobs.count] = ellipses.u[lane] + ellipses.step_u[lane] * along;
            jobs.v[jobs.count] = ellipses.v[lane] + ellipses.step_v[lane] * along;
            jobs.share[jobs.count] = share;
            jobs.add_level(pyramid, fine, jobs.fine);
            jobs.add_level(pyramid, coarse, jobs.coarse);
        }
    }
    for (const int end = (jobs.count + kWidth - 1) / kWidth * kWidth, last = jobs.count - 1; jobs.count < end;
         ++jobs.count) {
        jobs.u[jobs.count] = jobs.u[last], jobs.v[jobs.count] = jobs.v[last], jobs.share[jobs.count] = 0.0f;
        jobs.add_level(pyramid, 0, jobs.fine);
        jobs.add_level(pyramid, 0, jobs.coarse);
    }
}

HWY_INLINE IVec floor_of(F f, Vec x) {
    const I d;
    const IVec i = hn::ConvertTo(d, x);
    return hn::IfThenElse(hn::RebindMask(d, hn::Lt(x, hn::ConvertTo(f, i))), hn::Sub(i, hn::Set(d, 1)), i);
}

// between() of scene/texture.cpp: two texels, and the share of the second.
struct Between {
    IVec first, second;
    Vec share;
};

HWY_INLINE IVec wrapped(Wrap wrap, IVec i, IVec n) {
    const I d;
    const IVec zero = hn::Zero(d), one = hn::Set(d, 1);
    if (wrap == Wrap::kClampToEdge) return hn::Min(hn::Max(i, zero), hn::Sub(n, one));
    // No further than a texel outside of the period.
    const IVec period = wrap == Wrap::kRepeat ? n : hn::Add(n, n);
    i = hn::IfThenElse(hn::Lt(i, zero), hn::Add(i, period), i);
    i = hn::IfThenElse(hn::Gt(period, i), i, hn::Sub(i, period));
    return hn::IfThenElse(hn::Lt(i, n), i, hn::Sub(hn::Sub(period, one), i));
}

HWY_INLINE Between between(Wrap wrap, Vec x, IVec n) {
    const F f;
    const I d;
    if (wrap == Wrap::kClampToEdge) {
        const Vec one = hn::Set(f, 1.0f);
        x = hn::IfThenElseZero(hn::Gt(x, hn::Zero(f)), hn::IfThenElse(hn::Lt(one, x), one, x));
    } else {
        x = hn::IfThenElseZero(hn::Lt(hn::Abs(x), hn::Set(f, 0x1p23f)), x);
        if (wrap == Wrap::kRepeat) {
            x = hn::Sub(x, hn::ConvertTo(f, floor_of(f, x)));
        } else {
            const IVec half = floor_of(f, hn::Mul(hn::Set(f, 0.5f), x));
            x = hn::Sub(x, hn::Mul(hn::Set(f, 2.0f), hn::ConvertTo(f, half)));
        }
    }
    x = hn::Sub(hn::Mul(x, hn::ConvertTo(f, n)), hn::Set(f, 0.5f));
    const IVec i = floor_of(f, x);
    return {wrapped(wrap, i, n), wrapped(wrap, hn::Add(i, hn::Set(d, 1)), n), hn::Sub(x, hn::ConvertTo(f, i))};
}

HWY_INLINE Vec mix(Vec a, Vec b, Vec share) {
    return hn::Add(a, hn::Mul(hn::Sub(b, a), share));
}

// Pyramid::bilinear()
HWY_INLINE void bilinear(const TextureLanes& work, const LevelJobs& level, const Jobs& jobs, int at, Vec out[4]) {
    const F f;
    const I d;
    const BoundTexture& texture = *work.texture;
    const IVec width = hn::Load(d, level.width + at), first = hn::Load(d, level.first + at);
    const Between x = between(texture.ref.wrap_s, hn::Load(f, jobs.u + at), width);
    const Between y = between(texture.ref.wrap_t, hn::Load(f, jobs.v + at), hn::Load(d, level.height + at));
    const IVec upper = hn::Add(first, hn::Mul(y.first, width)), lower = hn::Add(first, hn::Mul(y.second, width));
    const auto* texels = reinterpret_cast<const std::int32_t*>(texture.pyramid->texels().data());
    const IVec a = hn::GatherIndex(d, texels, hn::Add(upper, x.first)),
               b = hn::GatherIndex(d, texels, hn::Add(upper, x.second)),
               c = hn::GatherIndex(d, texels, hn::Add(lower, x.first)),
               e = hn::GatherIndex(d, texels, hn::Add(lower, x.second));
    const float* colors = texture.pyramid->color_of_code().data();
    const IVec code = hn::Set(d, 255);
    for (int k = 0; k < work.channels; ++k) {
        const int channel = work.first_channel + k;
        const auto decoded = [&](IVec texel) HWY_ATTR {
            const IVec here = hn::And(hn::ShiftRightSame(texel, 8 * channel), code);
            if (channel == 3) return hn::Mul(hn::ConvertTo(f, here), hn::Set(f, 1.0f / 255.0f));
            return hn::GatherIndex(f, colors, here);
        };
        const Vec above = mix(decoded(a), decoded(b), x.share), below = mix(decoded(c), decoded(e), x.share);
        out[k] = mix(above, below, y.share);
    }
}

void sample_lanes(const TextureLanes& work) {
    Ellipses ellipses;
    for (int first = 0; first < work.batch->count; first += kWidth) find_ellipses(work, first, ellipses);
    Jobs jobs;
    list_jobs(work, ellipses, jobs);

    const F f;
    alignas(64) float results[4][kMostJobs];
    for (int at = 0; at < jobs.count; at += kWidth) {
        Vec fine[4], coarse[4];
        bilinear(work, jobs.fine, jobs, at, fine);
        const Vec share = hn::Load(f, jobs.share + at);
        if (!hn::AllFalse(f, hn::Gt(share, hn::Zero(f)))) {
            bilinear(work, jobs.coarse, jobs, at, coarse);
            for (int k = 0; k < work.channels; ++k) fine[k] = mix(fine[k], coarse[k], share);
        }
        for (int k = 0; k < work.channels; ++k) hn::Store(fine[k], f, results[k] + at);
    }
    for (int lane = 0, at = 0; lane < work.batch->count; ++lane) {
        const int taps = static_cast<int>(ellipses.taps[lane]);
        for (int k = 0; k < work.channels; ++k) {
            float sum = 0.0f;
            for (int i = 0; i < taps; ++i) sum += results[k][at + i];
            work.out[k][lane] = sum / static_cast<float>(taps);
        }
        at += taps;
    }
}

}  // namespace

SampleTextureLanes sample_lanes_function() {
    return sample_lanes;
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/cpu_dispatch.h"

namespace pentaprism {

SampleTextureLanes sample_texture_lanes() {
    PENTAPRISM_RETURN_FOR_CPU(sample_lanes_function());
    return HWY_STATIC_DISPATCH(sample_lanes_function)();
}

}  // namespace pentaprism
#endif
