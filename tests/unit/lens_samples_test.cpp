// Where samples fall on lenses of odd shapes, and in the sample patterns that can be chosen.
#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>
#include <pentaprism/error.h>
#include <set>

#include "sample/aperture.h"
#include "sample/pixel_pattern.h"
#include "sample/sample_table.h"

namespace pentaprism {
namespace {

constexpr int kWidth = 640, kHeight = 360;

TEST(CatsEye, FillsWhatTwoDisksShareEvenly) {
    constexpr int kGrid = 300;
    const CatsEye eye(1.2, kWidth, kHeight, 1.0);
    for (const auto& [x, y] : {std::pair(600.0, 20.0), std::pair(320.0, 340.0), std::pair(10.0, 180.0)}) {
        const CatsEye::Outline outline = eye.outline(x, y);
        const glm::dvec2 move = 1.2 * glm::dvec2(x - 320, 180 - y) / std::hypot(320.0, 180.0);
        const auto left = [&](double u, double v) {
            return std::hypot(u, v) <= 1.0 && std::hypot(u - move.x, v - move.y) <= 1.0;
        };
        // Means of some functions over samples that fill the disk evenly, and over what is left, by a grid.
        const std::function<double(double, double)> functions[] = {[](double u, double) { return u; },
                                                                   [](double, double v) { return v; },
                                                                   [](double u, double v) { return u * v; },
                                                                   [](double u, double) { return u * u; },
                                                                   [](double u, double) { return u > 0.3; },
                                                                   [](double, double v) { return v > -0.1; },
                                                                   [](double u, double v) { return u + v > 0.4; }};
        for (const auto& f : functions) {
            double samples = 0, grid = 0, area = 0;
            for (int i = 0; i < kGrid; ++i)
                for (int j = 0; j < kGrid; ++j) {
                    const glm::dvec2 disk = aperture_point(Lens{}, (i + 0.5) / kGrid, (j + 0.5) / kGrid);
                    const glm::vec2 p = outline.at(glm::vec2(disk));
                    ASSERT_LE(std::hypot(p.x, p.y), 1.0 + 1e-6);
                    ASSERT_LE(std::hypot(p.x - move.x, p.y - move.y), 1.0 + 1e-3);
                    samples += f(p.x, p.y) / (kGrid * kGrid);
                    const double u = 2 * (i + 0.5) / kGrid - 1, v = 2 * (j + 0.5) / kGrid - 1;
                    if (!left(u, v)) continue;
                    grid += f(u, v);
                    area += 1;
                }
            EXPECT_NEAR(samples, grid / area, 3e-3) << "at " << x << ", " << y;
        }
    }
}

TEST(CatsEye, LeavesTheMiddleOfThePictureAloneAndStretchesWithTheRatio) {
    const CatsEye round(1.0, kWidth, kHeight, 1.0), tall(1.0, kWidth, kHeight, 2.0);
    for (int i = 0; i < 200; ++i) {
        const glm::vec2 p(aperture_point(Lens{}, (i + 0.5) / 200, std::fmod(0.618 * i, 1.0)));
        const glm::vec2 q = round.outline(320.5, 180.5).at(p);
        EXPECT_NEAR(q.x, p.x, 5e-3);
        EXPECT_NEAR(q.y, p.y, 5e-3);
        const glm::vec2 a = round.outline(600, 20).at(p), b = tall.outline(600, 20).at({p.x, 2.0f * p.y});
        EXPECT_NEAR(a.x, b.x, 1e-5);
        EXPECT_NEAR(2.0f * a.y, b.y, 1e-5);
    }
    EXPECT_FALSE(CatsEye().on());
}

TEST(SampleTable, HasTheSameCatsEyeHoweverItIsAsked) {
    Shutter rolling;
    rolling.rolling = RollingShutter::kTop;
    rolling.exposure_share = 0.25;
    for (const Grouping grouping : {Grouping::kStill, Grouping::kDefocus, Grouping::kBoth})
        for (const int spp : {4, 16, 20}) {
            const SampleTable table(spp, 3, Lens{}, grouping, SamplePattern::kFree,
                                    SampleTimes(rolling, kWidth, kHeight), CatsEye(1.5, kWidth, kHeight, 1.0));
            std::vector<SampleVector> cell_room, block_room;
            std::vector<Domain> domain_room;
            int changed = 0;
            for (const auto& [cx, cy] : {std::pair(0, 0), std::pair(19, 3), std::pair(7, 10)}) {
                const auto cell = table.cell(cx, cy, cell_room);
                const auto domains = table.domains(cx, cy, domain_room);
                for (const Stratum& s : table.strata(cx, cy))
                    for (int b = 0; b < kBlocksPerCell; ++b) {
                        if ((s.blocks >> b & 1u) == 0) continue;
                        const int bx = cx * kCellBlocks + b % kCellBlocks, by = cy * kCellBlocks + b / kCellBlocks;
                        const SampleVector& v = cell[static_cast<std::size_t>(b) * spp + s.slot];
                        const SampleVector& same = table.block(bx, by, block_room)[s.slot];
                        const auto indices = table.indices(bx, by);
                        const Domain& d = domains[s.stratum];
                        for (int lane = 0; lane < kLanes; ++lane) {
                            const SamplePoint p =
                                table.sample(bx * kBlockSize + lane % kBlockSize, by * kBlockSize + lane / kBlockSize,
                                             indices[static_cast<std::size_t>(s.slot) * kLanes + lane]);
                            ASSERT_TRUE(v.u[lane] == same.u[lane] && v.v[lane] == same.v[lane]);
                            ASSERT_TRUE(v.u[lane] == p.u && v.v[lane] == p.v && v.t[lane] == p.t);
                            ASSERT_TRUE(p.u >= d.u0 && p.u <= d.u1 && p.v >= d.v0 && p.v <= d.v1 && p.t >= d.t0 &&
                                        p.t <= d.t1);
                            changed += p.u != table.block(bx, by)[s.slot].u[lane];
                        }
                    }
            }
            EXPECT_GT(changed, 1000);
        }
}

TEST(ApertureImage, SpreadsSamplesAsThePictureIsBright) {
    constexpr int kSide = 32, kGrid = 512;
    std::vector<float> luminance(kSide * kSide);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) luminance[y * kSide + x] = x < 16 ? 0.0f : y < 16 ? 3.0f : 1.0f;
    luminance[0] = 1e6f;                         // in a corner: not on the lens
    luminance[20 * kSide + 20] = -5.0f;          // nothing
    luminance[21 * kSide + 21] = std::nanf("");  // nothing
    const ApertureImage image(kSide, kSide, luminance, "test");
    int above = 0, dark = 0;
    for (int i = 0; i < kGrid; ++i)
        for (int j = 0; j < kGrid; ++j) {
            const glm::dvec2 p = image.point((i + 0.5) / kGrid, (j + 0.5) / kGrid);
            ASSERT_LE(std::hypot(p.x, p.y), 1.0 + 1e-12);
            ASSERT_GE(p.x, 0.0);
            above += p.y > 0;
            const int x = static_cast<int>((p.x + 1) * 16), y = static_cast<int>((1 - p.y) * 16);
            dark += (x == 20 && y == 20) || (x == 21 && y == 21);
        }
    int cells = 0;  // of a quarter, whole in the circle
    for (int y = 0; y < 16; ++y)
        for (int x = 16; x < 32; ++x) cells += std::hypot((x + 1) / 16.0 - 1, 1 - y / 16.0) <= 1.0;
    EXPECT_NEAR(above / double(kGrid * kGrid), 3.0 * cells / (4.0 * cells - 2.0), 1e-3);
    EXPECT_EQ(dark, 0);
    EXPECT_THROW(ApertureImage(2, 2, {1, 1, 1, 1}, "corners alone"), Error);
    EXPECT_THROW(read_aperture_image("there is no such file.png"), Error);
}

TEST(ApertureImage, KeepsStrataWhole) {
    const ApertureImage even(64, 64, std::vector<float>(64 * 64, 1.0f), "even");
    // Neighbours stay neighbours, but for a jump at the edges of rows that differ in length.
    for (int i = 0; i < 63; ++i)
        for (int j = 0; j < 63; ++j) {
            const glm::dvec2 a = even.point((i + 0.5) / 64, (j + 0.5) / 64),
                             b = even.point((i + 1.5) / 64, (j + 0.5) / 64);
            EXPECT_GT(b.x, a.x);
            EXPECT_LT(b.x - a.x, 0.05);
        }
}

constexpr Sampler kOthers[] = {Sampler::kSobol, Sampler::kBlueNoise, Sampler::kIndependent};

// Whether the top bits of (a, b) fall once in each cell of every grid of 2^i x 2^(m - i).
bool is_net(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& points) {
    int m = 0;
    while ((std::size_t{1} << m) < points.size()) ++m;
    for (int i = 0; i <= m; ++i) {
        std::set<std::pair<std::uint64_t, std::uint64_t>> cells;
        for (const auto& [a, b] : points)
            cells.emplace(std::uint64_t{a} >> (32 - i), std::uint64_t{b} >> (32 - (m - i)));
        if (cells.size() != points.size()) return false;
    }
    return true;
}

TEST(PixelPattern, IsANetInThePixelAndOnTheLens) {
    for (const Sampler sampler : {Sampler::kSobol, Sampler::kBlueNoise})
        for (const std::uint32_t spp : {4u, 8u, 16u, 64u})
            for (std::uint32_t pixel = 0; pixel < 40; ++pixel) {
                std::vector<std::pair<std::uint32_t, std::uint32_t>> xy, uv;
                std::set<std::uint32_t> times;
                for (std::uint32_t i = 0; i < spp; ++i) {
                    const PatternPoint p = pattern_point(sampler, pixel, 3 * pixel, i, spp, 9);
                    xy.emplace_back(p.x, p.y);
                    uv.emplace_back(p.u, p.v);
                    times.insert(static_cast<std::uint32_t>((std::uint64_t{p.t} * spp) >> 32));
                }
                EXPECT_TRUE(is_net(xy)) << spp;
                EXPECT_EQ(times.size(), spp) << "one time in each interval";
                if (spp == 16 || (sampler == Sampler::kSobol && spp < 16)) {
                    EXPECT_TRUE(is_net(uv)) << spp;
                }
            }
}

TEST(PixelPattern, OfNeighboursGoesTogetherInBlueNoise) {
    // Four pixels that share the upper digits of their place have 4 N points of the sequence: a net of their own.
    for (std::uint32_t pixel = 0; pixel < 20; ++pixel) {
        std::vector<std::pair<std::uint32_t, std::uint32_t>> xy, uv;
        for (std::uint32_t k = 0; k < 4; ++k)
            for (std::uint32_t i = 0; i < 4; ++i) {
                const PatternPoint p =
                    pattern_point(Sampler::kBlueNoise, 2 * pixel + k % 2, 4 * pixel + k / 2, i, 4, 1);
                xy.emplace_back(p.x, p.y);
                uv.emplace_back(p.u, p.v);
            }
        EXPECT_TRUE(is_net(xy));
        EXPECT_TRUE(is_net(uv));
    }
}

TEST(SampleTable, HoldsEverySampleOfEveryPatternOnce) {
    for (const Sampler sampler : kOthers)
        for (const Grouping grouping : {Grouping::kStill, Grouping::kMotion, Grouping::kDefocus, Grouping::kBoth})
            for (const int spp : {1, 3, 16, 100}) {
                const SampleTable table(spp, 6, Lens{}, grouping, SamplePattern::kFree, {}, {}, sampler);
                std::vector<Domain> room;
                const auto domains = table.domains(1, 2, room);
                ASSERT_LE(domains.size(), 64u);
                for (const Stratum& s : table.strata(1, 2)) {
                    ASSERT_LT(s.stratum, domains.size());
                    const Domain& d = domains[s.stratum];
                    for (int b = 0; b < kBlocksPerCell; ++b) {
                        if ((s.blocks >> b & 1u) == 0) continue;
                        const SampleVector& v =
                            table.block(kCellBlocks + b % kCellBlocks, 2 * kCellBlocks + b / kCellBlocks)[s.slot];
                        for (int lane = 0; lane < kLanes; ++lane)
                            ASSERT_TRUE(v.u[lane] >= d.u0 && v.u[lane] <= d.u1 && v.v[lane] >= d.v0 &&
                                        v.v[lane] <= d.v1 && v.t[lane] >= d.t0 && v.t[lane] <= d.t1);
                    }
                }
                for (const auto& [px, py] : {std::pair(5, 9), std::pair(300, 77)}) {
                    std::set<int> slots;
                    for (int i = 0; i < spp; ++i) {
                        slots.insert(table.slot_of(px, py, i));
                        const SamplePoint p = table.sample(px, py, i);
                        ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1 && p.t >= 0 && p.t < 1);
                        ASSERT_LE(std::hypot(p.u, p.v), 1 + 1e-6);
                    }
                    ASSERT_EQ(slots.size(), static_cast<std::size_t>(spp));
                }
            }
}

}  // namespace
}  // namespace pentaprism
