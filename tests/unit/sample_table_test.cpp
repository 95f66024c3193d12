// The 5D sample pattern keeps what is promised of it (docs/develop/algorithms.md 9.1): stratified in time, a net in
// every pair of dimensions, uniform, and the same however the table is arranged.
#include "sample/sample_table.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <numbers>
#include <set>
#include <vector>

#include "sample/aperture.h"
#include "sample/net.h"

namespace pentaprism {
namespace {

constexpr Grouping kGroupings[] = {Grouping::kStill, Grouping::kMotion, Grouping::kDefocus, Grouping::kBoth,
                                   Grouping::kTime};
constexpr int kCounts[] = {1, 2, 3, 4, 5, 7, 8, 13, 16, 20, 37, 64, 100, 256};

// Where on the unit square the lens point came from: the inverse of the concentric map.
std::array<double, 2> from_disk(double u, double v) {
    const double radius = std::hypot(u, v), quarter = std::numbers::pi / 4;
    double angle = std::atan2(v, u);
    double a, b;
    if (std::abs(u) > std::abs(v)) {
        a = std::copysign(radius, u);
        if (u < 0) angle += angle > 0 ? -std::numbers::pi : std::numbers::pi;
        b = a * angle / quarter;
    } else {
        b = std::copysign(radius, v);
        angle = v < 0 ? angle + std::numbers::pi : angle;
        a = b * (2 * quarter - angle) / quarter;
    }
    return {(a + 1) / 2, (b + 1) / 2};
}

using Point5 = std::array<double, 5>;  // x, y, p, q, t in [0, 1)

std::vector<Point5> points_of_pixel(const SampleTable& table, int px, int py) {
    std::vector<Point5> points;
    for (int i = 0; i < table.spp(); ++i) {
        const SamplePoint s = table.sample(px, py, i);
        const auto [p, q] = from_disk(s.u, s.v);
        points.push_back({s.x, s.y, p, q, s.t});
    }
    return points;
}

// Whether each box of 4^digits[d] equal parts along each dimension d holds exactly one point.
bool one_in_each_box(const std::vector<Point5>& points, const std::array<int, 5>& digits) {
    std::set<std::array<int, 5>> boxes;
    for (const Point5& point : points) {
        std::array<int, 5> box;
        for (int d = 0; d < 5; ++d) box[d] = static_cast<int>(std::min(point[d], 1 - 1e-9) * (1 << (2 * digits[d])));
        boxes.insert(box);
    }
    return boxes.size() == points.size();
}

template <class Visit>
void for_each_digits(int m, Visit&& visit) {
    for (int code = 0; code < 3125; ++code) {
        std::array<int, 5> digits;
        int rest = code, sum = 0, used = 0;
        for (int& d : digits) d = rest % 5, rest /= 5, sum += d, used += d > 0;
        if (sum == m) visit(digits, used);
    }
}

TEST(Net, PutsOnePointInEveryElementaryBoxOfFourDimensionsAndTheIndex) {
    for (int m = 1; m <= 4; ++m) {
        const int n = 1 << (2 * m);
        std::vector<Point5> points;
        for (int i = 0; i < n; ++i) {
            const auto c = net_point(static_cast<std::uint32_t>(i));
            points.push_back({c[0] * 0x1p-32, c[1] * 0x1p-32, c[2] * 0x1p-32, c[3] * 0x1p-32, (i + 0.5) / n});
        }
        for_each_digits(m, [&](const std::array<int, 5>& digits, int) {
            EXPECT_TRUE(one_in_each_box(points, digits))
                << "N = " << n << ", digits " << digits[0] << digits[1] << digits[2] << digits[3] << digits[4];
        });
    }
}

TEST(OwenScrambling, KeepsEveryBinaryIntervalWhole) {
    for (std::uint32_t seed : {1u, 77u, 0xdeadbeefu})
        for (int bits = 1; bits <= 8; ++bits) {
            std::set<std::uint32_t> prefixes;
            for (std::uint32_t i = 0; i < (1u << bits); ++i) {
                const std::uint32_t low = owen_scramble(i << (32 - bits), seed),
                                    high = owen_scramble((i << (32 - bits)) | 0x3ffu, seed);
                EXPECT_EQ(low >> (32 - bits), high >> (32 - bits));
                prefixes.insert(low >> (32 - bits));
            }
            EXPECT_EQ(prefixes.size(), 1u << bits);
        }
}

TEST(SampleTable, PutsOneSampleInEachIntervalOfTheShutterForEveryCount) {
    for (const int spp : kCounts) {
        const SampleTable table(spp, 3, Lens{}, Grouping::kMotion);
        for (int pixel = 0; pixel < 64; ++pixel) {
            std::vector<int> seen(spp, 0);
            for (int i = 0; i < spp; ++i)
                ++seen[static_cast<int>(static_cast<double>(table.sample(pixel, 7 * pixel, i).t) * spp)];
            EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }))
                << spp << " samples, pixel " << pixel;
        }
    }
}

TEST(SampleTable, IsANetInEveryPairOfDimensionsAndForSixteenSamplesInAllFive) {
    for (const int m : {1, 2, 3, 4}) {
        const int spp = 1 << (2 * m);
        const SampleTable table(spp, 9, Lens{}, Grouping::kBoth);
        for (int pixel = 0; pixel < 48; ++pixel) {
            const auto points = points_of_pixel(table, 5 * pixel, pixel);
            for_each_digits(m, [&](const std::array<int, 5>& digits, int used) {
                if (used > 2 && m != 2) return;
                EXPECT_TRUE(one_in_each_box(points, digits))
                    << spp << " samples, pixel " << pixel << ", digits " << digits[0] << digits[1] << digits[2]
                    << digits[3] << digits[4];
            });
        }
    }
}

// Whether each box of a power of two of equal parts along x, y and t, as many boxes as points, holds exactly one.
bool one_in_each_binary_box(const std::vector<std::array<double, 3>>& points) {
    const int bits = static_cast<int>(std::bit_width(points.size())) - 1;
    for (int of_x = 0; of_x <= bits; ++of_x)
        for (int of_y = 0; of_x + of_y <= bits; ++of_y) {
            const double parts[3] = {std::ldexp(1, of_x), std::ldexp(1, of_y), std::ldexp(1, bits - of_x - of_y)};
            std::set<std::array<int, 3>> boxes;
            for (const auto& p : points) {
                std::array<int, 3> box;
                for (int d = 0; d < 3; ++d) box[d] = static_cast<int>(p[d] * parts[d]);
                boxes.insert(box);
            }
            if (boxes.size() != points.size()) return false;
        }
    return true;
}

TEST(SampleTable, IsANetInPlaceAndTimeOverPixelsAndBlocksWhereOnlyMotionBlurs) {
    for (const int spp : {1, 2, 4, 8, 16, 64}) {
        const SampleTable table(spp, 9, Lens{}, Grouping::kMotion);
        for (int block = 0; block < 12; ++block) {
            std::vector<std::array<double, 3>> of_block;
            for (int lane = 0; lane < kLanes; ++lane) {
                std::vector<std::array<double, 3>> of_pixel;
                const int column = lane % kBlockSize, row = lane / kBlockSize;
                for (int i = 0; i < spp; ++i) {
                    const SamplePoint s = table.sample(kBlockSize * 5 * block + column, kBlockSize * block + row, i);
                    of_pixel.push_back({s.x, s.y, s.t});
                    of_block.push_back({(column + s.x) / kBlockSize, (row + s.y) / kBlockSize, s.t});
                }
                EXPECT_TRUE(one_in_each_binary_box(of_pixel)) << spp << " samples, block " << block << ", " << lane;
            }
            EXPECT_TRUE(one_in_each_binary_box(of_block)) << spp << " samples, block " << block;
        }
    }
}

TEST(SampleTable, SpreadsTwoSamplesOverHalvesAndFourOverQuadrants) {
    for (const int spp : {2, 4}) {
        const SampleTable table(spp, 4, Lens{}, Grouping::kBoth);
        for (int pixel = 0; pixel < 48; ++pixel) {
            const auto points = points_of_pixel(table, pixel, 3 * pixel);
            for (const int d : {0, 2}) {
                std::set<int> quadrants;
                for (const Point5& p : points) quadrants.insert((p[d] >= 0.5) * 2 + (p[d + 1] >= 0.5));
                EXPECT_EQ(quadrants.size(), points.size());
            }
        }
    }
}

TEST(SampleTable, GivesASampleThatDoesNotDependOnTheGroupingUnlessOnlyMotionBlurs) {
    for (const int spp : {1, 3, 4, 16, 20, 100}) {
        std::vector<SampleTable> tables;
        for (const Grouping grouping : {Grouping::kStill, Grouping::kDefocus, Grouping::kBoth, Grouping::kTime})
            tables.emplace_back(spp, 5, Lens{}, grouping);
        for (int pixel = 0; pixel < 200; ++pixel)
            for (int i = 0; i < spp; ++i) {
                const SamplePoint first = tables[0].sample(31 * pixel, 17 * pixel, i);
                for (const SampleTable& table : tables) {
                    const SamplePoint s = table.sample(31 * pixel, 17 * pixel, i);
                    ASSERT_TRUE(s.x == first.x && s.y == first.y && s.u == first.u && s.v == first.v && s.t == first.t)
                        << spp << " samples, pixel " << pixel << ", index " << i;
                }
            }
    }
}

TEST(SampleTable, HoldsEverySampleOfABlockOnceWhereItsIndexSays) {
    for (const Grouping grouping : kGroupings)
        for (const int spp : kCounts) {
            const SampleTable table(spp, 6, Lens{}, grouping);
            for (const auto& [bx, by] : {std::pair(0, 0), std::pair(9, 2), std::pair(100, 333)}) {
                const auto block = table.block(bx, by);
                const auto indices = table.indices(bx, by);
                ASSERT_EQ(block.size(), static_cast<std::size_t>(table.slots()));
                for (int lane = 0; lane < kLanes; ++lane) {
                    const int column = lane % kBlockSize, row = lane / kBlockSize, px = bx * kBlockSize + column,
                              py = by * kBlockSize + row;
                    std::set<int> seen;
                    for (int slot = 0; slot < table.slots(); ++slot) {
                        const int index = indices[static_cast<std::size_t>(slot) * kLanes + lane];
                        seen.insert(index);
                        ASSERT_EQ(table.slot_of(px, py, index), slot);
                        const SamplePoint s = table.sample(px, py, index);
                        const SampleVector& v = block[slot];
                        ASSERT_EQ(v.x[lane], static_cast<float>(px % kCellSize - kCellSize / 2) + s.x);
                        ASSERT_EQ(v.y[lane], static_cast<float>(kCellSize / 2 - py % kCellSize) - s.y);
                        ASSERT_TRUE(v.u[lane] == s.u && v.v[lane] == s.v && v.t[lane] == s.t);
                    }
                    ASSERT_EQ(seen.size(), static_cast<std::size_t>(spp));
                    ASSERT_EQ(*seen.rbegin(), spp - 1);
                }
            }
        }
}

TEST(SampleTable, PutsEveryVectorOfACellInOneStratumWhoseDomainHoldsItsSamples) {
    for (const Grouping grouping : kGroupings)
        for (const int spp : kCounts) {
            const SampleTable table(spp, 8, Lens{}, grouping);
            std::vector<Domain> room;
            const auto domains = table.domains(0, 0, room);
            ASSERT_LE(domains.size(), 64u);
            for (const auto& [cx, cy] : {std::pair(0, 0), std::pair(1, 5), std::pair(40, 3)}) {
                std::vector<std::uint64_t> seen(table.slots(), 0);
                for (const Stratum& s : table.strata(cx, cy)) {
                    ASSERT_LT(s.stratum, domains.size());
                    ASSERT_EQ(seen[s.slot] & s.blocks, 0u) << "twice";
                    seen[s.slot] |= s.blocks;
                    const Domain& d = domains[s.stratum];
                    for (int b = 0; b < kBlocksPerCell; ++b) {
                        if ((s.blocks >> b & 1) == 0) continue;
                        const SampleVector& v =
                            table.block(cx * kCellBlocks + b % kCellBlocks, cy * kCellBlocks + b / kCellBlocks)[s.slot];
                        for (int lane = 0; lane < kLanes; ++lane)
                            ASSERT_TRUE(v.u[lane] >= d.u0 && v.u[lane] <= d.u1 && v.v[lane] >= d.v0 &&
                                        v.v[lane] <= d.v1 && v.t[lane] >= d.t0 && v.t[lane] <= d.t1);
                    }
                }
                for (const std::uint64_t blocks : seen)
                    ASSERT_EQ(blocks, ~std::uint64_t{0}) << "a vector is in no stratum";
            }
        }
}

Shutter rolling_shutter(RollingShutter edge) {
    Shutter shutter;
    shutter.close = 1.0;
    shutter.rolling = edge;
    shutter.exposure_share = 0.4;
    shutter.curve = ShutterCurve(trapezoid_shutter(0.3, 0.5));
    return shutter;
}

TEST(SampleTable, DelaysSamplesOfARollingShutterWithinTheDomainsOfTheirCell) {
    constexpr int kWidth = 200, kHeight = 150;
    for (const RollingShutter edge : {RollingShutter::kTop, RollingShutter::kRight})
        for (const Grouping grouping : kGroupings)
            for (const int spp : {1, 5, 16}) {
                const SampleTimes times(rolling_shutter(edge), kWidth, kHeight);
                const SampleTable table(spp, 8, Lens{}, grouping, SamplePattern::kFree, times);
                std::vector<SampleVector> cell_room, block_room;
                std::vector<Domain> domain_room;
                for (const auto& [cx, cy] : {std::pair(0, 0), std::pair(6, 4), std::pair(2, 3)}) {
                    const auto cell = table.cell(cx, cy, cell_room);
                    const auto domains = table.domains(cx, cy, domain_room);
                    for (const Stratum& s : table.strata(cx, cy))
                        for (int b = 0; b < kBlocksPerCell; ++b) {
                            if ((s.blocks >> b & 1) == 0) continue;
                            const int bx = cx * kCellBlocks + b % kCellBlocks, by = cy * kCellBlocks + b / kCellBlocks;
                            const SampleVector& v = cell[b * table.slots() + s.slot];
                            const SampleVector& same = table.block(bx, by, block_room)[s.slot];
                            const SampleVector& within = table.block(bx, by)[s.slot];
                            const auto indices = table.indices(bx, by);
                            for (int lane = 0; lane < kLanes; ++lane) {
                                ASSERT_TRUE(v.t[lane] >= domains[s.stratum].t0 && v.t[lane] <= domains[s.stratum].t1);
                                ASSERT_EQ(v.t[lane], same.t[lane]);
                                const int px = bx * kBlockSize + lane % kBlockSize,
                                          py = by * kBlockSize + lane / kBlockSize;
                                const SamplePoint point =
                                    table.sample(px, py, indices[static_cast<std::size_t>(s.slot) * kLanes + lane]);
                                ASSERT_EQ(v.t[lane], point.t);
                                ASSERT_EQ(point.t, times.at(within.t[lane], px + point.x, py + point.y));
                            }
                        }
                }
            }
}

TEST(SampleTable, SpreadsTimesAsTheShutterCurveHasItsLightOneInEachPart) {
    Shutter shutter;
    shutter.curve = ShutterCurve(trapezoid_shutter(0.5, 0.5));  // light until t: 2 t^2 up to a half
    for (const int spp : {4, 16, 64}) {
        const SampleTable table(spp, 5, Lens{}, Grouping::kMotion, SamplePattern::kFree, SampleTimes(shutter, 8, 8));
        for (int pixel = 0; pixel < 16; ++pixel) {
            std::set<int> parts;
            for (int i = 0; i < spp; ++i) {
                const double t = table.sample(pixel, 3 * pixel, i).t;
                const double light = t < 0.5 ? 2 * t * t : 1 - 2 * (1 - t) * (1 - t);
                parts.insert(static_cast<int>(light * spp));
            }
            EXPECT_EQ(parts.size(), static_cast<std::size_t>(spp));
        }
    }
}

// Corners of the polygon on the unit circle; inside of each side, up to rounding.
bool inside_polygon(double u, double v, int blades, double rotation) {
    for (int k = 0; k < blades; ++k) {
        const double middle = rotation + 2 * std::numbers::pi * (k + 0.5) / blades;
        if (u * std::cos(middle) + v * std::sin(middle) > std::cos(std::numbers::pi / blades) + 1e-6) return false;
    }
    return true;
}

TEST(Aperture, RoundedBladesAreFilledEvenlyUpToTheirOutline) {
    constexpr int kGrid = 400;
    for (const int blades : {3, 5, 8})
        for (const double k : {0.0, 1e-6, 0.3, 0.8, 1.0}) {
            Lens lens;
            lens.blades = blades;
            lens.rotation_deg = 17.0;
            lens.roundness = k;
            const double half = std::numbers::pi / blades, c = std::cos(half);
            const auto outline = [&](double u, double v) {
                double a = std::atan2(v, u) - 17.0 * std::numbers::pi / 180.0;
                a -= 2 * half * std::floor(a / (2 * half));
                return (1 - k) * c / std::cos(a - half) + k;
            };
            // Of an even density the part within q times the outline is q^2, and the means of u^2 and v^2 are the
            // outline's: numerically, half the mean of R^4 over that of R^2.
            double inner = 0, square = 0, fourth = 0, second = 0;
            for (int i = 0; i < kGrid; ++i)
                for (int j = 0; j < kGrid; ++j) {
                    const glm::dvec2 p = aperture_point(lens, (i + 0.5) / kGrid, (j + 0.5) / kGrid);
                    const double r = std::hypot(p.x, p.y), most = outline(p.x, p.y);
                    ASSERT_LE(r, most + 1e-9);
                    inner += r < 0.5 * most;
                    square += r * r;
                }
            for (int i = 0; i < 100000; ++i) {
                const double a = 2 * std::numbers::pi * (i + 0.5) / 100000, most = outline(std::cos(a), std::sin(a));
                second += most * most;
                fourth += std::pow(most, 4);
            }
            EXPECT_NEAR(inner / (kGrid * kGrid), 0.25, 2e-3) << blades << " blades, roundness " << k;
            EXPECT_NEAR(square / (kGrid * kGrid), 0.5 * fourth / second, 2e-3) << blades << " blades, roundness " << k;
        }
}

TEST(Aperture, ARoundnessNearNothingMovesNoSampleFarAndOneIsTheDisk) {
    Lens straight, nearly, round, disk;
    straight.blades = nearly.blades = round.blades = 7;
    nearly.roundness = 1e-9;
    round.roundness = 1.0;
    for (int i = 0; i < 1000; ++i) {
        const double p = (i + 0.5) / 1000, q = std::fmod(0.618034 * i, 1.0);
        const glm::dvec2 a = aperture_point(straight, p, q), b = aperture_point(nearly, p, q),
                         c = aperture_point(round, p, q), d = aperture_point(disk, p, q);
        EXPECT_NEAR(glm::length(a - b), 0.0, 1e-7);
        EXPECT_NEAR(glm::length(c - d), 0.0, 1e-12);
    }
}

TEST(SampleTable, KeepsEverySampleInItsPixelOnTheLensAndBeforeTheShutterCloses) {
    for (const int blades : {0, 3, 5, 6, 9})
        for (const double ratio : {1.0, 0.5, 1.8})
            for (const int spp : {1, 7, 16, 100}) {
                Lens lens;
                lens.blades = blades;
                lens.rotation_deg = 17;
                lens.ratio = ratio;
                const SampleTable table(spp, 2, lens, Grouping::kBoth);
                for (int pixel = 0; pixel < 300; ++pixel)
                    for (int i = 0; i < spp; ++i) {
                        const SamplePoint s = table.sample(pixel, 11 * pixel, i);
                        ASSERT_TRUE(s.x >= 0 && s.x < 1 && s.y >= 0 && s.y < 1 && s.t >= 0 && s.t < 1);
                        ASSERT_TRUE(s.x * 256 == std::floor(s.x * 256) && s.y * 256 == std::floor(s.y * 256));
                        ASSERT_EQ(s.t * 16777216.0f, std::floor(s.t * 16777216.0f));
                        const double v = s.v / ratio;
                        ASSERT_LE(std::abs(s.v), static_cast<float>(ratio));
                        ASSERT_LE(std::hypot(s.u, v), 1 + 1e-6);
                        ASSERT_TRUE(inside_polygon(s.u, v, blades, 17 * std::numbers::pi / 180)) << s.u << " " << v;
                    }
            }
}

TEST(SampleTable, WorksForTheLargestAndForOddCounts) {
    for (const int spp : {1, 2, 3, 7, 16, 20, 37, 100, 1000, 4096}) {
        const SampleTable table(spp, 1, Lens{}, Grouping::kBoth);
        std::set<float> times;
        for (int i = 0; i < spp; ++i) times.insert(table.sample(12, 345, i).t);
        EXPECT_EQ(times.size(), static_cast<std::size_t>(spp));
        EXPECT_LT(*times.rbegin(), 1.0f);
    }
}

TEST(SampleTable, DiffersBetweenSeedsAndBetweenPixels) {
    const SampleTable a(16, 1, Lens{}, Grouping::kBoth), b(16, 2, Lens{}, Grouping::kBoth);
    int same_seed = 0, same_pixel = 0, same_period = 0;
    for (int pixel = 0; pixel < 500; ++pixel)
        for (int i = 0; i < 16; ++i) {
            const SamplePoint s = a.sample(pixel, 0, i);
            same_seed += s.u == b.sample(pixel, 0, i).u;
            same_pixel += s.u == a.sample(pixel + 1, 0, i).u;
            same_period += s.u == a.sample(pixel + 128, 0, i).u;
        }
    EXPECT_LT(same_seed, 20);
    EXPECT_LT(same_pixel, 20);
    EXPECT_LT(same_period, 16 * 500 / 2) << "the pattern repeats with its period all along a row";
}

// Chi-square of `bins` equally likely counts, as a normal deviate (Wilson & Hilferty 1931).
double deviate(const std::vector<int>& bins) {
    double total = 0, chi = 0;
    for (const int n : bins) total += n;
    const double expected = total / static_cast<double>(bins.size()), k = static_cast<double>(bins.size()) - 1;
    for (const int n : bins) chi += (n - expected) * (n - expected) / expected;
    return (std::cbrt(chi / k) - (1 - 2 / (9 * k))) / std::sqrt(2 / (9 * k));
}

TEST(SampleTable, HasUniformMarginals) {
    // One sample of each pixel, so that stratification does not hide a bias; too even is no fault here, so one-sided.
    // Seven questions a pattern at 4.5 sigma: a fault is reported wrongly once in 40 000 patterns, and the pattern is
    // fixed.
    for (const auto& [spp, grouping] :
         {std::pair(1, Grouping::kStill), std::pair(5, Grouping::kStill), std::pair(16, Grouping::kStill),
          std::pair(1, Grouping::kMotion), std::pair(5, Grouping::kMotion), std::pair(16, Grouping::kMotion)}) {
        const SampleTable table(spp, 12, Lens{}, grouping);
        std::array<std::vector<int>, 5> line;
        for (auto& bins : line) bins.assign(64, 0);
        std::vector<int> lens(32 * 32, 0), time_and_lens(32 * 32, 0);
        for (int py = 0; py < 128; ++py)
            for (int px = 0; px < 128; ++px)
                for (int i = 0; i < spp; ++i) {
                    const SamplePoint s = table.sample(px, py, i);
                    const auto [p, q] = from_disk(s.u, s.v);
                    const double c[5] = {s.x, s.y, std::min(p, 1 - 1e-9), std::min(q, 1 - 1e-9), s.t};
                    for (int d = 0; d < 5; ++d) ++line[d][static_cast<int>(c[d] * 64)];
                    ++lens[static_cast<int>(c[2] * 32) * 32 + static_cast<int>(c[3] * 32)];
                    ++time_and_lens[static_cast<int>(c[4] * 32) * 32 + static_cast<int>(c[2] * 32)];
                }
        for (int d = 0; d < 5; ++d) EXPECT_LT(deviate(line[d]), 4.5) << spp << " samples, dimension " << d;
        EXPECT_LT(deviate(lens), 4.5) << spp;
        EXPECT_LT(deviate(time_and_lens), 4.5) << spp;
    }
}

TEST(Aperture, MapsEqualAreasToEqualAreas) {
    // The Jacobian of the map by differences, at points away from the seams, is the area of the stop.
    for (const int blades : {0, 3, 6, 9}) {
        Lens lens;
        lens.blades = blades;
        lens.rotation_deg = 10;
        const double area = blades == 0 ? std::numbers::pi : 0.5 * blades * std::sin(2 * std::numbers::pi / blades);
        int checked = 0;
        for (int i = 0; i < 40; ++i)
            for (int j = 0; j < 40; ++j) {
                const double p = (i + 0.37) / 40, q = (j + 0.61) / 40, h = 1e-6;
                const glm::dvec2 o = aperture_point(lens, p, q), dp = (aperture_point(lens, p + h, q) - o) / h,
                                 dq = (aperture_point(lens, p, q + h) - o) / h;
                const double jacobian = std::abs(dp.x * dq.y - dp.y * dq.x);
                checked += std::abs(jacobian - area) < 1e-3 * area;
            }
        EXPECT_GT(checked, 1590) << blades << " blades";
    }
}

}  // namespace
}  // namespace pentaprism
