// How well the sample pattern integrates what it is for: an edge that moves, an edge out of focus, and both.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "support/edges.h"

namespace pentaprism {
namespace {

using support::Edge;
using support::estimate;
using support::exact;
using support::golden;
using support::kEdges;

// Root mean square error over 64x64 pixels, each with the edge somewhere else.
double rmse(const Edge& edge, int spp) {
    const SampleTable table(spp, 17, Lens{}, Grouping::kStill);
    double sum = 0;
    int n = 0;
    for (int py = 0; py < 64; ++py)
        for (int px = 0; px < 64; ++px, ++n) {
            const double a = -edge.blur + golden(n) * (1 + edge.motion + 2 * edge.blur);
            const double error = estimate(table, edge, px, py, a) - exact(edge, a);
            sum += error * error;
        }
    return std::sqrt(sum / n);
}

TEST(Sampling, ErrorFallsAtLeastWithTheRootOfTheSampleCount) {
    for (const Edge& edge : kEdges) {
        const double one = rmse(edge, 1);
        std::printf("  edge %s: rmse * sqrt(N), N = 1: %.4f", edge.name, one);
        for (const int spp : {2, 4, 7, 16, 20, 64, 256}) {
            const double error = rmse(edge, spp);
            std::printf("; %d: %.4f", spp, error * std::sqrt(spp));
            EXPECT_LT(error, 1.05 * one / std::sqrt(spp)) << edge.name << ", " << spp << " samples";
            if (spp == 16) {
                EXPECT_LT(error, 0.75 * one / 4) << edge.name << ": stratification should show";
            }
            if (spp == 256) {
                EXPECT_LT(error, 0.5 * one / 16) << edge.name << ": stratification should show";
            }
        }
        std::printf("\n");
    }
}

TEST(Sampling, MeanIsUnbiasedOverSeeds) {
    // Mean error of a picture for each of 48 seeds; their mean is 0 within their own standard error. 4 edges x 2 counts
    // x 3 places: 24 questions. A false alarm of 1 in 1000 over all (Sidak) is 4.2e-5 each: 4.5 standard errors of
    // Student's t, 47 degrees of freedom.
    constexpr int kSeeds = 48;
    for (const int spp : {1, 4})
        for (const double place : {0.2, 0.5, 0.7}) {
            std::vector<std::vector<double>> errors(std::size(kEdges));
            for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
                const SampleTable table(spp, 1000 + seed, Lens{}, Grouping::kStill);
                for (std::size_t e = 0; e < std::size(kEdges); ++e) {
                    const Edge& edge = kEdges[e];
                    const double a = -edge.blur + place * (1 + edge.motion + 2 * edge.blur), truth = exact(edge, a);
                    double sum = 0;
                    for (int py = 0; py < 48; ++py)
                        for (int px = 0; px < 48; ++px) sum += estimate(table, edge, px, py, a) - truth;
                    errors[e].push_back(sum / (48 * 48));
                }
            }
            for (std::size_t e = 0; e < std::size(kEdges); ++e) {
                double mean = 0, variance = 0;
                for (const double error : errors[e]) mean += error / kSeeds;
                for (const double error : errors[e]) variance += (error - mean) * (error - mean) / (kSeeds - 1);
                if (variance == 0) {  // strata that the edge does not cut: each seed is exact
                    EXPECT_NEAR(mean, 0.0, 1e-12);
                    continue;
                }
                const double deviations = mean / std::sqrt(variance / kSeeds);
                EXPECT_LT(std::abs(deviations), 4.5) << kEdges[e].name << ", " << spp << " samples, place " << place;
            }
        }
}

TEST(Sampling, BlocksOfPixelsErrLikePixelsThatAreSampledFreely) {
    // The pixels of a block share strata of lens and time. If their errors went together, blotches would show: the
    // error of a block's mean against that of sixteen independent pixels.
    for (const Edge& edge : kEdges)
        for (const int spp : {4, 16, 64}) {
            double pixels = 0, blocks = 0;
            int n = 0;
            for (std::uint32_t seed = 0; seed < 10; ++seed) {
                const SampleTable table(spp, 50 + seed, Lens{}, Grouping::kStill);
                for (int by = 0; by < 16; ++by)
                    for (int bx = 0; bx < 16; ++bx, ++n) {
                        const double a = -edge.blur + golden(n) * (4 + edge.motion + 2 * edge.blur);
                        double sum = 0;
                        for (int lane = 0; lane < kLanes; ++lane) {
                            const int column = lane % kBlockSize, px = bx * kBlockSize + column,
                                      py = by * kBlockSize + lane / kBlockSize;
                            const double error = estimate(table, edge, px, py, a - column) - exact(edge, a - column);
                            pixels += error * error / kLanes;
                            sum += error / kLanes;
                        }
                        blocks += sum * sum;
                    }
            }
            const double ratio = std::sqrt(blocks * kLanes / pixels);
            std::printf("  edge %s, %d samples: blocks err %.2f times as much as free pixels\n", edge.name, spp, ratio);
            EXPECT_LT(ratio, 1.1) << edge.name << ", " << spp << " samples";
        }
}

}  // namespace
}  // namespace pentaprism
