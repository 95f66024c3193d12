// A point's sixteen map samples at a time: which texels they are, and whether what the light sees there is the point.
// The same operations in the same order on every CPU target, none of them fused: the same bits. Compiled once for each.

#include "shade/shadow_lookup.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/shadow_lookup.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <hwy/highway.h>

#include "base/bytes_at-inl.h"
#include "sample/net.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
constexpr int kAll = ShadowPoint::kLanes;
using F = hn::CappedTag<float, kAll>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using Vec = hn::Vec<F>;
using IVec = hn::Vec<I>;
using Mask = hn::Mask<F>;
using Path = ShadowReceiver::Path;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(F()));

// Of a receiver's plane beyond its own triangle, texels: in front of it less is believed than behind it.
constexpr float kFarthestBehind = 12.0f, kFarthestBefore = 100.0f;
constexpr float kBias = 0.2f;  // texels
constexpr int kAttempts = 16;  // texels along a moving point's way
constexpr int kSamples = ShadowMap::kSamples;
static_assert(kSamples == 4 && kAll == 16 && kCellSize == 32, "shifts and masks below");

struct Place {
    Vec x, y, z;
};

HWY_INLINE Vec plus_product(Vec sum, Vec a, Vec b) {
    return hn::Add(sum, hn::Mul(a, b));
}

HWY_INLINE std::uint32_t bits_of(F f, Mask mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(f, mask, bytes);
    return bytes[0] | static_cast<std::uint32_t>(kWidth > 8 ? bytes[1] : 0) << 8;
}

// mix() of sample/net.h.
HWY_INLINE hn::Vec<U> mixed(U u, hn::Vec<U> h) {
    h = hn::Mul(hn::Xor(h, hn::ShiftRight<16>(h)), hn::Set(u, 0x7feb352du));
    h = hn::Mul(hn::Xor(h, hn::ShiftRight<15>(h)), hn::Set(u, 0x846ca68bu));
    return hn::Xor(h, hn::ShiftRight<16>(h));
}

// Of a small exponent; std::ldexp() is a call.
HWY_INLINE float power_of_two(int exponent) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(exponent + 127) << 23);
}

// The point that has these barycentrics, of corners that are the same in all lanes.
HWY_INLINE Place blend(F f, const Vec b[3], const float* corners, const Place& offset) {
    Place p = offset;
    for (int k = 0; k < 3; ++k) {
        p.x = plus_product(p.x, b[k], hn::Set(f, corners[3 * k]));
        p.y = plus_product(p.y, b[k], hn::Set(f, corners[3 * k + 1]));
        p.z = plus_product(p.z, b[k], hn::Set(f, corners[3 * k + 2]));
    }
    return p;
}

// Entry `index` of a table, other in each lane, of `size` entries; ShadowReceiver::kReadable may be read.
HWY_INLINE Vec entry(F f, const float* table, IVec index, int size) {
    if constexpr (kWidth >= 8)
        if (size <= kWidth) return hn::TableLookupLanes(hn::LoadU(f, table), hn::IndicesFromVec(f, index));
    return hn::GatherIndex(f, table, index);
}

// The point that has these barycentrics, of corners as they are at the border `index` of quarters.
HWY_INLINE Place blend_at(F f, const Vec b[3], const ShadowReceiver& receiver, IVec index, const Place& offset) {
    Place p = offset;
    const auto coordinate = [&](int i)
                                HWY_ATTR { return entry(f, receiver.at_borders(i), index, ShadowMap::kSamples + 1); };
    for (int k = 0; k < 3; ++k) {
        p.x = plus_product(p.x, b[k], coordinate(3 * k));
        p.y = plus_product(p.y, b[k], coordinate(3 * k + 1));
        p.z = plus_product(p.z, b[k], coordinate(3 * k + 2));
    }
    return p;
}

// Sixteen map samples of one point.
template <Path kPath, bool kPerspective>
class Lookup {
  public:
    Lookup(ShadowReceiver& receiver, const ShadowPoint& point, std::uint32_t seed)
        : receiver_(receiver), point_(point), seed_(seed) {
        const LightView& view = receiver.map().view();
        const bool none = point.offset == glm::vec3(0.0f);
        for (int axis = 0; axis < 3; ++axis) offset_[axis] = none ? 0.0f : glm::dot(view.axes[axis], point.offset);
        half_ = 0.5f * static_cast<float>(receiver.map().width());
    }

    HWY_INLINE std::uint32_t lit() {
        float reach = 0.0f, depth = 0.0f;
        for (int first = 0; first < kAll; first += kWidth)
            if (!find_ways(first, reach, depth)) return 0xffff;
        if (!choose_level(reach, depth)) return 0xffff;
        std::uint32_t lit = 0;
        for (int first = 0; first < kAll; first += kWidth) lit |= compare(first) << first;
        return lit;
    }

  private:
    Place offset(F f) const { return {hn::Set(f, offset_[0]), hn::Set(f, offset_[1]), hn::Set(f, offset_[2])}; }
    HWY_INLINE IVec quarter(I d, int first) const { return hn::ShiftRight<2>(hn::Iota(d, first)); }
    HWY_INLINE Mask asked(I d, IVec quarter) const {
        const IVec bit =
            hn::And(hn::Set(d, static_cast<std::int32_t>(point_.quarters)), hn::Shl(hn::Set(d, 1), quarter));
        return hn::RebindMask(F(), hn::Ne(bit, hn::Zero(d)));
    }
    HWY_INLINE void barycentrics(F f, int first, Vec b[3]) const {
        for (int k = 0; k < 3; ++k) b[k] = hn::Load(f, point_.barycentrics[k] + first);
    }

    // Where the points are when their quarter begins, and the way to where they are when it ends; in tangents or
    // metres. A straight line between is near enough to find the texels in which they are seen. False if a point is
    // behind the light.
    HWY_INLINE bool find_ways(int first, float& reach, float& depth) {
        const F f;
        const I d;
        const IVec q = quarter(d, first);
        const Mask wanted = asked(d, q);
        if (hn::AllFalse(f, wanted)) return true;
        Vec b[3];
        barycentrics(f, first, b);
        Place begin, end;
        if constexpr (kPath == Path::kStill) {
            begin = end = blend(f, b, receiver_.knots(), offset(f));
        } else if constexpr (kPath == Path::kStraight) {
            const Place open = blend(f, b, receiver_.knots(), offset(f));
            const Place close = blend(f, b, receiver_.knots() + 9, offset(f));
            const Vec s = hn::Mul(hn::ConvertTo(f, q), hn::Set(f, 1.0f / kSamples));
            const Vec change[3] = {hn::Sub(close.x, open.x), hn::Sub(close.y, open.y), hn::Sub(close.z, open.z)};
            const auto at = [&](Vec s) HWY_ATTR {
                return Place{plus_product(open.x, s, change[0]), plus_product(open.y, s, change[1]),
                             plus_product(open.z, s, change[2])};
            };
            begin = at(s);
            end = at(hn::Add(s, hn::Set(f, 1.0f / kSamples)));
        } else {
            begin = blend_at(f, b, receiver_, q, offset(f));
            end = blend_at(f, b, receiver_, hn::Add(q, hn::Set(d, 1)), offset(f));
        }
        Vec bx = begin.x, by = begin.y, ex = end.x, ey = end.y;
        if constexpr (kPerspective) {
            const Mask behind = hn::Not(hn::And(hn::Gt(begin.z, hn::Zero(f)), hn::Gt(end.z, hn::Zero(f))));
            if (!hn::AllFalse(f, hn::And(behind, wanted))) return false;
            bx = hn::Div(bx, begin.z), by = hn::Div(by, begin.z);
            ex = hn::Div(ex, end.z), ey = hn::Div(ey, end.z);
        }
        hn::Store(bx, f, from_x_ + first);
        hn::Store(by, f, from_y_ + first);
        hn::Store(hn::Sub(ex, bx), f, way_x_ + first);
        hn::Store(hn::Sub(ey, by), f, way_y_ + first);
        const auto most = [&](float so_far, Vec here) HWY_ATTR {
            return std::max(so_far, hn::GetLane(hn::MaxOfLanes(f, hn::IfThenElseZero(wanted, here))));
        };
        reach = most(reach, hn::Max(hn::Max(hn::Abs(bx), hn::Abs(by)), hn::Max(hn::Abs(ex), hn::Abs(ey))));
        if constexpr (kPerspective) depth = most(depth, hn::Max(begin.z, end.z));
        return true;
    }

    // Coarser than asked for if a point would lie beyond the level's edge. False if it lies beyond all.
    HWY_INLINE bool choose_level(float reach, float depth) {
        const ShadowMap& map = receiver_.map();
        float distance = 1.0f;
        if constexpr (kPerspective) {
            distance = glm::dot(point_.position - map.view().position, map.view().axes[2]);
            if (!(distance > 1e-3f)) return false;
            if (!(reach < 0.99f * kWidestTangent)) return false;
        }
        exponent_ = map.exponent_of(point_.texel / distance);
        const float edge = half_ - static_cast<float>(kCellSize);
        while (exponent_ < ShadowMap::kCoarsest && !(reach < edge * power_of_two(exponent_))) ++exponent_;
        const float texel = power_of_two(exponent_);
        scale_ = 1.0f / texel;
        if constexpr (kPerspective)
            limit_ = map.limit_of(depth * (1.0f + kFarthestBehind * texel));
        else
            limit_ = map.limit_of(INFINITY);
        return reach < edge * texel;
    }

    // Texels of one place for each lane.
    struct Texels {
        IVec x, y, key, index;  // of the map; of the cell; of the sample in it
    };
    HWY_INLINE Texels texels(F f, Vec x, Vec y, IVec quarter) const {
        const I d;
        const Vec half = hn::Set(f, half_);
        const IVec px = hn::ConvertTo(d, hn::Add(x, half)), py = hn::ConvertTo(d, hn::Sub(half, y));
        const IVec in_cell = hn::Set(d, kCellSize - 1);
        const IVec texel = hn::Add(hn::ShiftLeft<5>(hn::And(py, in_cell)), hn::And(px, in_cell));
        const IVec index = hn::Add(hn::ShiftLeft<2>(texel), quarter);
        return {px, py, hn::Add(hn::ShiftLeft<16>(hn::ShiftRight<5>(py)), hn::ShiftRight<5>(px)), index};
    }

    // Calls visit(lanes, cell) for each cell of the map that wanted lanes lie in.
    template <class Visit>
    HWY_INLINE void for_each_cell(F f, IVec key, Mask wanted, const Visit& visit) const {
        const I d;
        HWY_ALIGN std::int32_t keys[kWidth];
        hn::Store(key, d, keys);
        while (!hn::AllFalse(f, wanted)) {
            const std::int32_t next = keys[hn::FindKnownFirstTrue(f, wanted)];
            const Mask here = hn::And(wanted, hn::RebindMask(f, hn::Eq(key, hn::Set(d, next))));
            visit(here, receiver_.cell(exponent_, limit_, next));
            wanted = hn::AndNot(here, wanted);
        }
    }

    // Where in its texel, or when in its quarter, a sample is, by some bits of each word. Exact.
    template <int kFirst, int kBits>
    HWY_INLINE Vec share(F f, IVec word) const {
        const U u;
        const auto above = hn::ShiftLeft<32 - kFirst - kBits>(hn::BitCast(u, word));
        const IVec bits = hn::BitCast(I(), hn::ShiftRight<32 - kBits>(above));
        constexpr float kStep = 1.0f / (1 << kBits);
        return plus_product(hn::Set(f, 0.5f * kStep), hn::ConvertTo(f, bits), hn::Set(f, kStep));
    }

    // When in their quarters the map's samples there are; for that the cells need not be drawn.
    HWY_INLINE Vec times(F f, const Texels& at, Mask wanted) const {
        const I d;
        const U u;
        const ShadowSamples& samples = receiver_.map().samples();
        // ShadowSamples::index_of()
        constexpr int kToCell = std::countr_zero(unsigned{kCellSize}),
                      kToPeriod = kToCell + std::countr_zero(unsigned{ShadowSamples::kPeriod});
        const auto x = hn::BitCast(u, at.x), y = hn::BitCast(u, at.y);
        const auto hash = mixed(u, hn::Add(mixed(u, hn::Add(hn::ShiftRight<kToPeriod>(x), hn::Set(u, samples.seed()))),
                                           hn::ShiftRight<kToPeriod>(y)));
        const auto in_period = [&](auto cell, auto shift) HWY_ATTR {
            return hn::And(hn::Add(cell, shift), hn::Set(u, ShadowSamples::kPeriod - 1));
        };
        const auto column = in_period(hn::ShiftRight<kToCell>(x), hash),
                   row = in_period(hn::ShiftRight<kToCell>(y), hn::ShiftRight<8>(hash));
        const auto cell = hn::Add(hn::Mul(row, hn::Set(u, ShadowSamples::kPeriod)), column);
        const IVec place = hn::Add(hn::Mul(hn::BitCast(d, cell), hn::Set(d, ShadowSamples::kPerCell)), at.index);
        const IVec parts = bytes_at(d, samples.times(), hn::IfThenElseZero(hn::RebindMask(d, wanted), place));
        return share<0, ShadowSamples::kTimeBits>(f, parts);
    }

    // A map sample tells of the point only if the point is there at the sample's time: texels along the way are tried
    // until one is. Returns how far along.
    HWY_INLINE Vec search(F f, Vec x, Vec y, Vec way_x, Vec way_y, Vec tau, IVec q, Mask wanted) const {
        const Vec far = hn::Set(f, 0.5f), one = hn::Set(f, 1.0f);
        Mask open = hn::And(wanted, hn::Gt(hn::Max(hn::Abs(way_x), hn::Abs(way_y)), far));
        Vec least = hn::Set(f, INFINITY), best = tau;
        for (int attempt = 0; attempt < kAttempts && !hn::AllFalse(f, open); ++attempt) {
            const Texels at = texels(f, plus_product(x, tau, way_x), plus_product(y, tau, way_y), q);
            const Vec late = hn::Sub(times(f, at, open), tau);
            const Vec miss = hn::Max(hn::Abs(hn::Mul(late, way_x)), hn::Abs(hn::Mul(late, way_y)));
            const Mask better = hn::And(open, hn::Lt(miss, least));
            least = hn::IfThenElse(better, miss, least);
            best = hn::IfThenElse(better, tau, best);
            open = hn::And(open, hn::Not(hn::Le(miss, far)));
            tau = hn::Add(tau, hn::Set(f, 0.618034f));
            tau = hn::IfThenElse(hn::Ge(tau, one), hn::Sub(tau, one), tau);
        }
        return best;
    }

    // Two numbers in [0, 1/2), the same for the four lanes of a quarter.
    HWY_INLINE void jitter(F f, IVec quarter, Vec& x, Vec& y) const {
        const U u;
        const auto h = mixed(u, hn::Add(hn::Set(u, seed_), hn::BitCast(u, hn::ShiftLeft<1>(quarter))));
        const Vec unit = hn::Set(f, 0.5f / 65536.0f);
        const I d;
        x = hn::Mul(hn::ConvertTo(f, hn::BitCast(d, hn::And(h, hn::Set(u, 0xffffu)))), unit);
        y = hn::Mul(hn::ConvertTo(f, hn::BitCast(d, hn::ShiftRight<16>(h))), unit);
    }

    HWY_INLINE std::uint32_t compare(int first) {
        const F f;
        const I d;
        const IVec q = quarter(d, first);
        const Mask wanted = asked(d, q);
        constexpr std::uint32_t kEvery = kWidth < 16 ? (1u << kWidth) - 1 : 0xffff;
        if (hn::AllFalse(f, wanted)) return kEvery;

        // One place in each quarter of a texel's square around the point: with one sample for each texel that is
        // bilinear filtering, on the average.
        const Vec half = hn::Set(f, 0.5f), scale = hn::Set(f, scale_);
        const IVec corner = hn::And(hn::Iota(d, first), hn::Set(d, 3));
        const Vec corner_x = hn::ConvertTo(f, hn::And(corner, hn::Set(d, 1)));
        const Vec corner_y = hn::ConvertTo(f, hn::ShiftRight<1>(corner));
        Vec jitter_x, jitter_y;
        jitter(f, q, jitter_x, jitter_y);
        const auto start = [&](const float* from, Vec jitter, Vec corner) HWY_ATTR {
            const Vec shift = hn::Sub(plus_product(jitter, half, corner), half);
            return plus_product(shift, hn::Load(f, from + first), scale);
        };
        Vec x = start(from_x_, jitter_x, corner_x), y = start(from_y_, jitter_y, corner_y);
        if constexpr (kPath != Path::kStill) {
            const Vec way_x = hn::Mul(hn::Load(f, way_x_ + first), scale),
                      way_y = hn::Mul(hn::Load(f, way_y_ + first), scale);
            Vec tau = plus_product(hn::Mul(half, jitter_x), hn::Set(f, 0.25f), hn::ConvertTo(f, corner));
            tau = search(f, x, y, way_x, way_y, tau, q, wanted);
            x = plus_product(x, tau, way_x);
            y = plus_product(y, tau, way_y);
        }

        const Texels at = texels(f, x, y, q);
        Vec occluder = hn::Set(f, INFINITY);
        IVec words = hn::Zero(d);
        for_each_cell(f, at.key, wanted, [&](Mask here, const ShadowReceiver::Cell& cell) HWY_ATTR {
            occluder = hn::IfThenElse(here, hn::GatherIndex(f, cell.depths, at.index), occluder);
            words = hn::IfThenElse(hn::RebindMask(d, here), hn::GatherIndex(d, cell.samples, at.index), words);
        });
        if (hn::AllTrue(f, hn::Eq(occluder, hn::Set(f, INFINITY)))) return kEvery;
        // From the middle of the map.
        constexpr int kPlaceBits = ShadowSamples::kPlaceBits;
        const Vec whole = hn::Set(f, half_), bottom = hn::Set(f, half_ - 1.0f);
        const Vec sample_x = hn::Add(share<0, kPlaceBits>(f, words), hn::Sub(hn::ConvertTo(f, at.x), whole));
        const Vec sample_y = hn::Add(share<kPlaceBits, kPlaceBits>(f, words), hn::Sub(bottom, hn::ConvertTo(f, at.y)));
        Vec t = hn::Zero(f);
        if constexpr (kPath != Path::kStill)
            t = hn::Mul(hn::Add(hn::ConvertTo(f, q), share<2 * kPlaceBits, ShadowSamples::kTimeBits>(f, words)),
                        hn::Set(f, 1.0f / kSamples));
        return bits_of(f, hn::Or(hn::Not(wanted), is_lit(f, first, sample_x, sample_y, t, occluder)));
    }

    // The plane of the triangle at the sample's time, seen where the sample is (as cover/exact.h does), against how
    // deep the nearest triangle there may be where the point is.
    HWY_INLINE Mask is_lit(F f, int first, Vec sample_x, Vec sample_y, Vec t, Vec occluder) const {
        Vec X[3], Y[3], z[3];
        Vec b[3];
        barycentrics(f, first, b);
        const Vec scale = hn::Set(f, scale_);
        const I d;
        IVec segment = hn::Zero(d);
        Vec s = t;
        if constexpr (kPath == Path::kInPieces) {
            const Vec along = hn::Mul(t, hn::Set(f, static_cast<float>(receiver_.segments())));
            segment = hn::Min(hn::ConvertTo(d, along), hn::Set(d, receiver_.segments() - 1));
            s = hn::Sub(along, hn::ConvertTo(f, segment));
        }
        for (int k = 0; k < 3; ++k) {
            Vec v[3];
            for (int axis = 0; axis < 3; ++axis) {
                if constexpr (kPath == Path::kInPieces) {
                    const float* table = receiver_.at_knots(3 * k + axis);
                    const int size = receiver_.segments() + 1;
                    const Vec now = entry(f, table, segment, size),
                              next = entry(f, table, hn::Add(segment, hn::Set(d, 1)), size);
                    v[axis] = plus_product(now, s, hn::Sub(next, now));
                } else {
                    const float* knot = receiver_.knots() + 3 * k + axis;
                    v[axis] = hn::Set(f, knot[0]);
                    if constexpr (kPath == Path::kStraight)
                        v[axis] = plus_product(v[axis], s, hn::Set(f, knot[9] - knot[0]));
                }
                v[axis] = hn::Add(v[axis], hn::Set(f, offset_[axis]));
            }
            X[k] = hn::Sub(hn::Mul(v[0], scale), kPerspective ? hn::Mul(sample_x, v[2]) : sample_x);
            Y[k] = hn::Sub(hn::Mul(v[1], scale), kPerspective ? hn::Mul(sample_y, v[2]) : sample_y);
            z[k] = v[2];
        }
        const auto cross = [](Vec ax, Vec by, Vec bx, Vec ay)
                               HWY_ATTR { return hn::Sub(hn::Mul(ax, by), hn::Mul(bx, ay)); };
        const Vec e0 = cross(X[1], Y[2], X[2], Y[1]), e1 = cross(X[2], Y[0], X[0], Y[2]),
                  e2 = cross(X[0], Y[1], X[1], Y[0]);
        const auto sum = [&](Vec p, Vec q, Vec r)
                             HWY_ATTR { return plus_product(plus_product(hn::Mul(p, z[0]), q, z[1]), r, z[2]); };
        const Vec own = sum(b[0], b[1], b[2]);
        Vec texel = hn::Set(f, 1.0f / scale_);
        if constexpr (kPerspective) texel = hn::Mul(texel, own);
        const auto mean = [&](Vec p, Vec q, Vec r) HWY_ATTR {
            const Vec depth = hn::Div(sum(p, q, r), hn::Add(hn::Add(p, q), r));
            return hn::IfThenElse(hn::IsFinite(depth), depth, own);
        };
        Vec depth = mean(e0, e1, e2);
        // Where a surface folds towards the light, the next facet lies before the plane beyond this one's edge, so
        // points do not recede further than that edge.
        const Vec zero = hn::Zero(f), sign = hn::And(hn::Add(hn::Add(e0, e1), e2), hn::Set(f, -0.0f));
        const auto inside = [&](Vec e) HWY_ATTR { return hn::Max(hn::Xor(e, sign), zero); };
        depth = hn::Min(depth, mean(inside(e0), inside(e1), inside(e2)));
        depth = hn::Max(depth, hn::Sub(own, hn::Mul(hn::Set(f, kFarthestBefore), texel)));
        depth = hn::Min(depth, plus_product(own, hn::Set(f, kFarthestBehind), texel));
        return hn::Le(depth, plus_product(occluder, hn::Set(f, kBias), texel));
    }

    ShadowReceiver& receiver_;
    const ShadowPoint& point_;
    std::uint32_t seed_;
    float offset_[3], half_, scale_ = 1.0f;
    int exponent_ = 0, limit_ = 0;
    HWY_ALIGN float from_x_[kAll], from_y_[kAll], way_x_[kAll], way_y_[kAll];
};

template <Path kPath>
std::uint32_t lit_along(ShadowReceiver& receiver, const ShadowPoint& point, std::uint32_t seed) {
    if (receiver.map().view().perspective) return Lookup<kPath, true>(receiver, point, seed).lit();
    return Lookup<kPath, false>(receiver, point, seed).lit();
}

std::uint32_t lit_lanes(ShadowReceiver& receiver, const ShadowPoint& point, std::uint32_t seed) {
    switch (receiver.path()) {
        case Path::kStill:
            return lit_along<Path::kStill>(receiver, point, seed);
        case Path::kStraight:
            return lit_along<Path::kStraight>(receiver, point, seed);
        case Path::kInPieces:
            break;
    }
    return lit_along<Path::kInPieces>(receiver, point, seed);
}

}  // namespace

ShadowLookup lookup() {
    return lit_lanes;
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/cpu_dispatch.h"

namespace pentaprism {

ShadowLookup shadow_lookup() {
    PENTAPRISM_RETURN_FOR_CPU(lookup());
    return HWY_STATIC_DISPATCH(lookup)();
}

}  // namespace pentaprism
#endif
