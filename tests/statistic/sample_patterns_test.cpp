// The patterns of --sampler, measured: error over sample count, in pixels and in what a viewer sees of them.
// docs/learn/sample-patterns.md shows the table that is printed here.
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <map>
#include <vector>

#include "support/edges.h"

namespace pentaprism {
namespace {

using support::Edge;
using support::estimate;
using support::exact;
using support::golden;
using support::kEdges;

struct Pattern {
    const char* name;
    Sampler sampler;
};
constexpr Pattern kPatterns[] = {{"stratified", Sampler::kStratified},
                                 {"sobol", Sampler::kSobol},
                                 {"blue-noise", Sampler::kBlueNoise},
                                 {"independent", Sampler::kIndependent}};
constexpr int kSide = 64;  // pixels

SampleTable table_of(Sampler sampler, int spp, std::uint32_t seed) {
    return SampleTable(spp, seed, Lens{}, Grouping::kStill, SamplePattern::kFree, {}, {}, sampler);
}

// Root mean square errors of pixels, and of means over 4 x 4 pixels of an edge that lies alike in all of them: what is
// left when eye or denoiser average.
struct Errors {
    double pixel = 0, block = 0;
};

Errors errors(Sampler sampler, const Edge& edge, int spp) {
    const SampleTable table = table_of(sampler, spp, 17);
    Errors sum;
    int n = 0;
    for (int by = 0; by < kSide; by += 4)
        for (int bx = 0; bx < kSide; bx += 4, ++n) {
            const double a = -edge.blur + golden(n) * (1 + edge.motion + 2 * edge.blur), truth = exact(edge, a);
            double mean = 0;
            for (int k = 0; k < 16; ++k) {
                const double error = estimate(table, edge, bx + k % 4, by + k / 4, a) - truth;
                sum.pixel += error * error / 16;
                mean += error / 16;
            }
            sum.block += mean * mean;
        }
    return {std::sqrt(sum.pixel / n), std::sqrt(sum.block / n)};
}

// log error = log constant + slope log N, by least squares. Counts without any error (256 points of a net on a lattice
// of 256 places) say nothing.
struct Fit {
    double slope, constant;
};
Fit fit(const std::map<int, double>& error_of) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (const auto& [spp, error] : error_of) {
        if (error == 0) continue;
        const double u = std::log(spp), v = std::log(error);
        n += 1, x += u, y += v, xx += u * u, xy += u * v;
    }
    const double slope = (n * xy - x * y) / (n * xx - x * x);
    return {slope, std::exp((y - slope * x) / n)};
}

TEST(SamplePatterns, ErrAsTheTableOfTheirPageSays) {
    for (const Edge& edge : kEdges) {
        std::map<int, double> independent;
        double slope_of_random = 0;
        for (auto it = std::rbegin(kPatterns); it != std::rend(kPatterns); ++it) {
            std::map<int, double> pixel, block;
            for (const int spp : {4, 16, 64, 256}) {
                const Errors e = errors(it->sampler, edge, spp);
                pixel[spp] = e.pixel;
                block[spp] = e.block;
            }
            const Fit f = fit(pixel);
            std::printf("| %-12s | %-11s | %.4f | %.4f | %.4f | %.4f | %5.2f | %.3f | %.4f |\n", edge.name, it->name,
                        pixel[4], pixel[16], pixel[64], pixel[256], f.slope, f.constant, block[16]);
            if (it->sampler == Sampler::kIndependent) {
                independent = pixel;
                slope_of_random = f.slope;
                EXPECT_NEAR(f.slope, -0.5, 0.03) << edge.name;
                continue;
            }
            EXPECT_LT(f.slope, slope_of_random - 0.04) << it->name << ", " << edge.name;
            for (const auto& [spp, error] : pixel)
                EXPECT_LT(error, (spp >= 16 ? 0.8 : 0.97) * independent[spp])
                    << it->name << ", " << edge.name << ", " << spp;
        }
    }
}

TEST(SamplePatterns, OfBlueNoiseErrsLessOverABlockThanPixelsOnTheirOwn) {
    for (const Edge& edge : kEdges) {
        const Errors alone = errors(Sampler::kSobol, edge, 16), together = errors(Sampler::kBlueNoise, edge, 16);
        EXPECT_LT(together.block, 0.75 * alone.block) << edge.name;
    }
}

TEST(SamplePatterns, AreUnbiased) {
    // As in Sampling.MeanIsUnbiasedOverSeeds: 3 patterns x 4 edges x 2 counts, 24 questions: 4.5 standard errors.
    constexpr int kSeeds = 48, kPixels = 32;
    for (const Pattern& pattern : kPatterns) {
        if (pattern.sampler == Sampler::kStratified) continue;
        for (const int spp : {1, 4}) {
            std::vector<double> errors_of[std::size(kEdges)];
            for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
                const SampleTable table = table_of(pattern.sampler, spp, 1000 + seed);
                for (std::size_t e = 0; e < std::size(kEdges); ++e) {
                    const Edge& edge = kEdges[e];
                    const double a = -edge.blur + 0.37 * (1 + edge.motion + 2 * edge.blur), truth = exact(edge, a);
                    double sum = 0;
                    for (int p = 0; p < kPixels * kPixels; ++p)
                        sum += estimate(table, edge, p % kPixels, p / kPixels, a) - truth;
                    errors_of[e].push_back(sum / (kPixels * kPixels));
                }
            }
            for (std::size_t e = 0; e < std::size(kEdges); ++e) {
                double mean = 0, variance = 0;
                for (const double error : errors_of[e]) mean += error / kSeeds;
                for (const double error : errors_of[e]) variance += (error - mean) * (error - mean) / (kSeeds - 1);
                EXPECT_LT(std::abs(mean), 4.5 * std::sqrt(variance / kSeeds) + 1e-12)
                    << pattern.name << ", " << kEdges[e].name << ", " << spp << " samples";
            }
        }
    }
}

}  // namespace
}  // namespace pentaprism
