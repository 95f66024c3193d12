// Patterns that share lens positions and times, and the pictures they make: known answers.
#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <set>

#include "cover/hits.h"
#include "render/visibility.h"
#include "sample/sample_table.h"
#include "support/visible.h"

namespace pentaprism {
namespace {

using support::Visible;

SampleTable table_of(SamplePattern pattern, int spp) {
    return SampleTable(spp, 3, Lens{}, Grouping::kBoth, pattern);
}

using LensTime = std::tuple<float, float, float>;

LensTime lens_time(const SamplePoint& sample) {
    return {sample.u, sample.v, sample.t};
}

TEST(SharedSamples, AccumulationHasOneLensPositionAndTimeForEachIndex) {
    const SampleTable table = table_of(SamplePattern::kAccumulation, 10);
    std::set<LensTime> all;
    for (int index = 0; index < 10; ++index) {
        const LensTime first = lens_time(table.sample(0, 0, index));
        all.insert(first);
        std::set<std::pair<float, float>> places;
        for (int py = 0; py < 150; py += 7)
            for (int px = 0; px < 150; px += 3) {
                const SamplePoint sample = table.sample(px, py, index);
                EXPECT_EQ(lens_time(sample), first);
                places.emplace(sample.x, sample.y);
            }
        EXPECT_GT(places.size(), 500u) << "x and y are each pixel's own";
        EXPECT_GE(std::get<2>(first), index / 10.0f);
        EXPECT_LT(std::get<2>(first), (index + 1) / 10.0f);
    }
    EXPECT_EQ(all.size(), 10u);
}

TEST(SharedSamples, InterleavedBlocksHoldEveryTripleOnce) {
    const std::map<int, int> sides = {{1, 8}, {2, 8}, {3, 8}, {4, 4}, {15, 4}, {16, 2}, {20, 2}, {64, 2}};
    for (const auto& [spp, side] : sides) {
        const SampleTable table = table_of(SamplePattern::kInterleaved, spp);
        const std::size_t n = static_cast<std::size_t>(spp) * side * side;
        std::set<LensTime> all;
        std::set<std::vector<LensTime>> orders;
        for (int by = 0; by < 64; by += side)
            for (int bx = 0; bx < 128; bx += side) {
                std::set<LensTime> block;
                std::vector<LensTime> first_pixel;
                for (int y = 0; y < side; ++y)
                    for (int x = 0; x < side; ++x)
                        for (int index = 0; index < spp; ++index) {
                            const SamplePoint sample = table.sample(bx + x, by + y, index);
                            block.insert(lens_time(sample));
                            EXPECT_EQ(static_cast<int>(sample.t * static_cast<float>(spp)), index)
                                << "each pixel has a sample in each part of the shutter";
                            if (x == 0 && y == 0) first_pixel.push_back(lens_time(sample));
                        }
                EXPECT_EQ(block.size(), n) << spp << " samples, block " << bx << ' ' << by;
                all.insert(block.begin(), block.end());
                orders.insert(first_pixel);
            }
        EXPECT_EQ(all.size(), n) << spp << " samples: the picture has no other triples";
        EXPECT_GT(orders.size(), 1u) << spp << " samples: blocks differ";
    }
}

TEST(SharedSamples, InterleavedPixelsSeeTheWholeLens) {
    // 16 samples of a pixel in the 16 cells of the lens' square; found back through the concentric map by its rings and
    // sectors: each quarter of the disk holds four.
    const SampleTable table = table_of(SamplePattern::kInterleaved, 16);
    for (int py = 0; py < 8; ++py)
        for (int px = 0; px < 8; ++px) {
            int quarter[4] = {};
            for (int index = 0; index < 16; ++index) {
                const SamplePoint sample = table.sample(px, py, index);
                ++quarter[(sample.u < 0) * 2 + (sample.v < 0)];
            }
            for (const int n : quarter) EXPECT_EQ(n, 4) << "pixel " << px << ' ' << py;
        }
}

TEST(SharedSamples, SamplesOfATripleAreThoseOfTheTable) {
    for (const SamplePattern pattern : {SamplePattern::kAccumulation, SamplePattern::kInterleaved})
        for (const int spp : {1, 5, 16}) {
            const SampleTable table = table_of(pattern, spp);
            const SharedSamples shared = table.shared(2, 1);
            std::vector<SampleVector> room;
            const std::span<const SampleVector> cell = table.cell(2, 1, room);
            std::set<std::uint32_t> places;
            ASSERT_EQ(shared.place.size(), 1024u * static_cast<unsigned>(spp));
            for (std::size_t i = 0; i < shared.place.size(); ++i) {
                const std::uint32_t place = shared.place[i];
                places.insert(place);
                const SampleVector& vector = cell[place / kLanes];
                const int lane = static_cast<int>(place) % kLanes;
                const auto& triple = shared.triples[i / (shared.side * shared.side)];
                EXPECT_EQ(shared.x[i], vector.x[lane]);
                EXPECT_EQ(shared.y[i], vector.y[lane]);
                EXPECT_EQ(LensTime(triple.u, triple.v, triple.t),
                          LensTime(vector.u[lane], vector.v[lane], vector.t[lane]));
                const int column = static_cast<int>(i) % shared.side,
                          row = static_cast<int>(i) / shared.side % shared.side;
                EXPECT_EQ(static_cast<int>(shared.x[i] + 16.0f) / shared.block_side, column);
                const int pixel_row =
                    static_cast<int>(place) / (kLanes * spp) / kCellBlocks * kBlockSize + lane / kBlockSize;
                EXPECT_EQ(pixel_row / shared.block_side, row);
            }
            EXPECT_EQ(places.size(), shared.place.size()) << "each place once";
        }
}

// Everything to the left of an edge that sweeps from left to right during the shutter, `travel` pixels.
Frame sweeping_half_plane(int width, int height, float travel) {
    Frame frame = support::empty_frame(width, height, true);
    const float left = -0.5f * static_cast<float>(width), h = static_cast<float>(height);
    const auto knot = [&](float edge) {
        return std::vector<glm::vec4>{
            {left - 1000.0f, -h, 1, 0}, {left + edge, -h, 1, 0}, {left + edge, h, 1, 0}, {left - 1000.0f, h, 1, 0}};
    };
    support::set_mesh(frame, {knot(0), knot(travel)}, {0, 1, 2, 0, 2, 3});
    return frame;
}

TEST(Accumulation, ASweepingHalfPlaneIsAStaircaseOfGhosts) {
    // 8 passes, 20 pixels from ghost to ghost on average: a pixel that no ghost cuts is covered in exactly as many
    // passes as have gone by, in every row alike.
    constexpr int kWidth = 160, kHeight = 20, kPasses = 8;
    const Frame frame = sweeping_half_plane(kWidth, kHeight, kWidth);
    const SampleTable table = table_of(SamplePattern::kAccumulation, kPasses);
    const Visible visible(frame, table);
    const std::span<const SharedSamples::Triple> passes = table.shared(0, 0).triples;
    std::set<int> levels;
    int cut = 0;
    for (int px = 0; px < kWidth; ++px) {
        int whole = 0, touched = 0;
        for (const auto& pass : passes) {
            whole += pass.t * kWidth >= static_cast<float>(px + 1);
            touched += pass.t * kWidth > static_cast<float>(px);
        }
        for (int py = 0; py < kHeight; ++py) {
            const int covered = visible.covered(px, py);
            if (whole == touched) {
                EXPECT_EQ(covered, whole) << "pixel " << px << ' ' << py;
                levels.insert(covered);
            } else {
                EXPECT_GE(covered, whole);
                EXPECT_LE(covered, touched);
            }
        }
        cut += whole != touched;
    }
    EXPECT_LE(cut, kPasses) << "one pixel for each ghost's edge";
    EXPECT_GE(levels.size(), 8u);
}

TEST(Interleaved, BlocksOfPixelsShowEveryTripleOfASweepingHalfPlane) {
    constexpr int kWidth = 800, kHeight = 8, kSpp = 4;  // 12.5 pixels from triple to triple on average
    const Frame frame = sweeping_half_plane(kWidth, kHeight, kWidth);
    const SampleTable table = table_of(SamplePattern::kInterleaved, kSpp);
    const Visible visible(frame, table);
    const SharedSamples shared = table.shared(0, 0);
    int exact = 0;
    for (int bx = 0; bx < kWidth; bx += shared.block_side) {
        int whole = 0, touched = 0;
        for (const auto& triple : shared.triples) {
            whole += triple.t * kWidth >= static_cast<float>(bx + shared.block_side);
            touched += triple.t * kWidth > static_cast<float>(bx);
        }
        for (int by = 0; by < kHeight; by += shared.block_side) {
            int covered = 0;
            for (int y = 0; y < shared.block_side; ++y)
                for (int x = 0; x < shared.block_side; ++x) covered += visible.covered(bx + x, by + y);
            EXPECT_GE(covered, whole);
            EXPECT_LE(covered, touched);
            exact += whole == touched;
        }
    }
    EXPECT_GT(exact, 200);
}

TEST(SharedSamples, AStillTriangleCostsOneTestForEachSampleOfItsBox) {
    // Nothing blurs: the box of every pass is that of the triangle, here 8 x 6 pixels, inside one tile.
    Frame frame = support::empty_frame(32, 32, false);
    support::set_mesh(frame, {{{-5.5f, -3.5f, 1, 0}, {1.5f, -3.5f, 1, 0}, {-5.5f, 1.5f, 1, 0}}}, {0, 1, 2});
    const SampleTable table = table_of(SamplePattern::kAccumulation, 5);
    const Visibility visibility(frame, table, {}, {0, 32, 0, 32});
    Hits hits;
    CoverCounts counts;
    for (const Tile& tile : visibility.tiles()) visibility.cover(tile, hits, counts);
    EXPECT_EQ(counts.tested, 5 * 8 * 6);
    EXPECT_GT(counts.covered, 0);
}

}  // namespace
}  // namespace pentaprism
