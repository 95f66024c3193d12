#include "sample/fine_lens.h"

#include <gtest/gtest.h>
#include <set>

#include "sample/sample_table.h"

namespace pentaprism {
namespace {

TEST(FineLens, HoldsEachSampleOnceInItsBlockAndItsStratum) {
    for (const int spp : {16, 32, 48, 64, 128, 256})
        for (const Grouping grouping : {Grouping::kDefocus, Grouping::kBoth}) {
            const SampleTable table(spp, 5, Lens{}, grouping);
            const FineLens& fine = table.fine_lens();
            ASSERT_FALSE(fine.empty()) << spp;
            EXPECT_EQ(fine.block_size(), spp < 64 ? 8 : 4);
            const int side = kCellSize / fine.block_size(), blocks = side * side;
            ASSERT_EQ(fine.strata().size(), static_cast<std::size_t>(fine.slots()));
            const std::size_t cell = table.cell_index(3, 2);
            const auto vectors = fine.cell(cell);
            const auto places = fine.places(cell);
            std::vector<SampleVector> room;
            const auto original = table.cell(3, 2, room);
            EXPECT_EQ(std::set<std::uint32_t>(places.begin(), places.end()).size(), original.size() * kLanes);
            for (std::size_t i = 0; i < places.size(); ++i) {
                const SampleVector &a = vectors[i / kLanes], &b = original[places[i] / kLanes];
                const std::size_t j = i % kLanes, k = places[i] % kLanes;
                ASSERT_TRUE(a.x[j] == b.x[k] && a.y[j] == b.y[k] && a.u[j] == b.u[k] && a.v[j] == b.v[k] &&
                            a.t[j] == b.t[k]);
                const int block = static_cast<int>(i / kLanes) % blocks, slot = static_cast<int>(i / kLanes) / blocks;
                ASSERT_EQ(std::min(static_cast<int>(a.x[j] + 16) / fine.block_size(), side - 1), block % side);
                ASSERT_TRUE(16 - a.y[j] >= static_cast<float>(block / side * fine.block_size()) &&
                            16 - a.y[j] <= static_cast<float>((block / side + 1) * fine.block_size()));
                const Stratum& stratum = fine.strata()[slot];
                ASSERT_EQ(stratum.slot, slot);
                ASSERT_TRUE(stratum.blocks >> (block / side * kCellBlocks + block % side) & 1u);
                const Domain& d = fine.domains()[stratum.stratum];
                ASSERT_TRUE(d.u0 <= a.u[j] && a.u[j] <= d.u1 && d.v0 <= a.v[j] && a.v[j] <= d.v1 && d.t0 <= a.t[j] &&
                            a.t[j] <= d.t1);
            }
            // Half as wide as a quarter of the lens: that is what it is for. The map to the disk stretches some.
            for (const Domain& d : fine.domains()) EXPECT_LT((d.u1 - d.u0) * (d.v1 - d.v0), 0.19f);
        }
}

TEST(FineLens, IsEmptyWhereItDoesNotHold) {
    for (const int spp : {1, 8, 20, 512}) EXPECT_TRUE(SampleTable(spp, 5, Lens{}, Grouping::kBoth).fine_lens().empty());
    for (const Grouping grouping : {Grouping::kStill, Grouping::kMotion})
        EXPECT_TRUE(SampleTable(16, 5, Lens{}, grouping).fine_lens().empty());
    EXPECT_TRUE(
        SampleTable(16, 5, Lens{}, Grouping::kBoth, SamplePattern::kFree, {}, {}, Sampler::kSobol).fine_lens().empty());
    EXPECT_TRUE(SampleTable(16, 5, Lens{}, Grouping::kBoth, SamplePattern::kFree, {}, CatsEye(0.5, 64, 64, 1.0))
                    .fine_lens()
                    .empty());
}

}  // namespace
}  // namespace pentaprism
