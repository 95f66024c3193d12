// Compiled once for each CPU target; the same operations in the same order, none of them fused.

#include "resolve/filter_block.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "resolve/filter_block.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <algorithm>
#include <hwy/highway.h>
#include <limits>

#include "shade/tile_shade.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, kLanes>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using Vec = hn::Vec<F>;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(F()));
constexpr int kFloatRun = 32;  // samples added in float before they are added in double
constexpr int kSums = BlockSums::kSums;

// What a run of samples is made of, lane by lane.
struct Run {
    alignas(64) float value[kFloatRun][4][kLanes], across[kFloatRun][3][kLanes], down[kFloatRun][3][kLanes];
};

// Entries of a table, copied lane by lane, which takes a third of the time of gathers, one for each component.
struct Entries {
    alignas(64) std::uint32_t number[kFloatRun][kLanes];
    alignas(64) Float4 entry[kFloatRun][kLanes];

    HWY_INLINE void copy_from(const Float4* table, int count) {
        for (int i = 0; i < count; ++i)
            for (int lane = 0; lane < kLanes; ++lane) entry[i][lane] = table[number[i][lane]];
    }
    template <std::size_t kComponents>
    HWY_INLINE void write(int i, int lane, float (&out)[kComponents][kLanes]) const {
        const F f;
        Vec component[4];
        hn::LoadInterleaved4(f, reinterpret_cast<const float*>(&entry[i][lane]), component[0], component[1],
                             component[2], component[3]);
        for (std::size_t k = 0; k < kComponents; ++k) hn::Store(component[k], f, out[k] + lane);
    }
};

void read(const BlockSamples& samples, int first, int count, Run& run, BlockSums& out) {
    const F f;
    const I d;
    const U u;
    const auto offset = [&](Vec x) HWY_ATTR {  // place_in_pixel()
        return hn::BitCast(u, hn::And(hn::ConvertTo(d, hn::Mul(x, hn::Set(f, 256.0f))), hn::Set(d, 255)));
    };
    Entries shown, across, down;
    for (int i = 0; i < count; ++i)
        for (int lane = 0; lane < kLanes; lane += kWidth) {
            const int slot = first + i;
            const auto point = hn::LoadU(u, samples.points + slot * kLanes + lane);
            // Lanes outside the tile hold anything.
            hn::Store(hn::Min(point, hn::Set(u, samples.background)), u, shown.number[i] + lane);
            hn::Store(offset(hn::Load(f, samples.vectors[slot].x + lane)), u, across.number[i] + lane);
            hn::Store(offset(hn::Neg(hn::Load(f, samples.vectors[slot].y + lane))), u, down.number[i] + lane);
            const Vec depth = hn::LoadU(f, samples.depths + slot * kLanes + lane);
            const auto hit = hn::RebindMask(f, hn::Ne(point, hn::Set(u, kBackground)));
            const Vec closest = hn::Load(f, out.depth + lane);
            hn::Store(hn::IfThenElse(hn::And(hit, hn::Lt(depth, closest)), depth, closest), f, out.depth + lane);
        }
    shown.copy_from(samples.shown, count);
    across.copy_from(samples.weights, count);
    down.copy_from(samples.weights, count);
    for (int i = 0; i < count; ++i)
        for (int lane = 0; lane < kLanes; lane += kWidth) {
            shown.write(i, lane, run.value[i]);
            across.write(i, lane, run.across[i]);
            down.write(i, lane, run.down[i]);
        }
}

using D = hn::CappedTag<double, 8>;

// What becomes of a run's sums: the first run's begin the totals, and the last one's end them.
struct Totals {
    bool begins, ends;
    double scale;  // of the whole numbers
    double (*total)[3][kSums][kLanes];
    std::int64_t (*fixed)[3][kSums][kLanes];
};

HWY_INLINE void add_to(const Totals& totals, const float* sums, int row, int column, int c, int lane) {
    constexpr double kMost = 0x1p21 * 0x1p32;  // tile_sums.cpp
    const D d;
    const hn::Rebind<float, D> floats;
    const hn::RebindToSigned<D> whole;
    const auto scale = hn::Set(d, totals.scale), most = hn::Set(d, kMost);
    for (int i = 0; i < kWidth; i += static_cast<int>(hn::Lanes(d))) {
        double* total = &totals.total[row][column][c][lane + i];
        auto sum = hn::PromoteTo(d, hn::Load(floats, sums + i));
        if (!totals.begins) sum = hn::Add(hn::Load(d, total), sum);
        if (totals.ends) {
            const auto fixed = hn::Min(hn::Max(hn::Mul(sum, scale), hn::Neg(most)), most);
            hn::Store(hn::ConvertTo(whole, hn::Round(fixed)), whole, &totals.fixed[row][column][c][lane + i]);
        } else {
            hn::Store(sum, d, total);
        }
    }
}

// The run's sums for the row of pixels `row`.
void add(const Run& run, int count, int row, int lane, const Totals& totals) {
    const F f;
    Vec sums[3][kSums];
    for (auto& of_column : sums)
        for (Vec& sum : of_column) sum = hn::Zero(f);
    for (int i = 0; i < count; ++i) {
        const Vec down = hn::Load(f, run.down[i][row] + lane);
        Vec value[4];
        for (int c = 0; c < 4; ++c) value[c] = hn::Load(f, run.value[i][c] + lane);
        for (int column = 0; column < 3; ++column) {
            const Vec weight = hn::Mul(hn::Load(f, run.across[i][column] + lane), down);
            for (int c = 0; c < 4; ++c) sums[column][c] = hn::Add(sums[column][c], hn::Mul(weight, value[c]));
            sums[column][4] = hn::Add(sums[column][4], weight);
        }
    }
    HWY_ALIGN float here[kWidth];
    for (int column = 0; column < 3; ++column)
        for (int c = 0; c < kSums; ++c) {
            hn::Store(sums[column][c], f, here);
            add_to(totals, here, row, column, c, lane);
        }
}

}  // namespace

void filter_samples(const BlockSamples& samples, BlockSums& out) {
    Run run;
    alignas(64) double total[3][3][kSums][kLanes];
    std::fill_n(out.depth, kLanes, std::numeric_limits<float>::infinity());
    for (int first = 0; first < samples.slots; first += kFloatRun) {
        const int count = std::min(kFloatRun, samples.slots - first);
        read(samples, first, count, run, out);
        const Totals totals{first == 0, first + count == samples.slots, samples.share * 0x1p32, total, out.fixed};
        for (int row = 0; row < 3; ++row)
            for (int lane = 0; lane < kLanes; lane += kWidth) add(run, count, row, lane, totals);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/cpu_dispatch.h"

namespace pentaprism {

FilterBlock filter_block() {
    PENTAPRISM_RETURN_FOR_CPU(filter_samples);
    return HWY_STATIC_DISPATCH(filter_samples);
}

}  // namespace pentaprism
#endif
