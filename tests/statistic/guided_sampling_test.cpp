// Placing samples by bounds: which estimators are without bias, and that the one that is not is found out.
#include "lab/guided_sampling.h"

#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <pentaprism/experiment.h>

#include "support/visible.h"

namespace pentaprism {
namespace {

constexpr int kSamples = 64, kSeeds = 400;

// Two surfaces, A before B, over pixel (0, 0) and beyond exactly while t is in [0, 1/2): at t = 1/2 they jump away,
// which two segments and a third knot far off make sharp to 1e-3.
Frame two_layers() {
    Frame frame = support::empty_frame(4, 4, true, 2);
    const auto layers = [](float x) {
        std::vector<glm::vec4> points;
        for (const float w : {1.0f, 2.0f})
            for (const auto& [px, py] :
                 {std::pair(-400.0f, -400.0f), std::pair(400.0f, -400.0f), std::pair(0.0f, 800.0f)})
                points.emplace_back((px + x) * w, py * w, w, 0.0f);
        return points;
    };
    support::set_mesh(frame, {layers(0), layers(0), layers(1e6f)}, {0, 1, 2, 3, 4, 5});
    return frame;
}

struct Estimate {
    glm::dvec3 mean{0.0}, error{0.0};  // error: standard error of the mean
};

// Red: A, green: B, blue: background.
Estimate estimate(Guidance guidance) {
    const Frame frame = two_layers();
    const GuidedSampler sampler(frame, {{1, 0, 0}, {0, 1, 0}}, {0, 0, 1});
    const GuidedSampler::Cell cell = sampler.bound(0, 0);
    const GuidedPixel& pixel = cell.pixels[5];
    glm::dvec3 sum(0.0), squares(0.0);
    std::int64_t tests = 0;
    for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
        const glm::dvec3 color = sampler.estimate(guidance, pixel, kSamples, seed * 0x9e3779b9u, tests);
        sum += color;
        squares += color * color;
    }
    Estimate result;
    result.mean = sum / static_cast<double>(kSeeds);
    for (int c = 0; c < 3; ++c)
        result.error[c] =
            std::sqrt(std::max(0.0, squares[c] / kSeeds - result.mean[c] * result.mean[c]) / (kSeeds - 1));
    return result;
}

// 15 questions in all; a false alarm in a thousand runs of all: 4 standard errors each. The jump takes 3e-4 of the
// shutter off or on.
constexpr double kDeviations = 4.0, kJump = 1e-3;

TEST(GuidedSampling, OnlyAZBufferOfPrivateSamplesIsBiasedWhereTwoLayersOverlap) {
    for (const Guidance guidance : {Guidance::kUnguided, Guidance::kEnumerated, Guidance::kStrata, Guidance::kTraced}) {
        const Estimate e = estimate(guidance);
        EXPECT_NEAR(e.mean.x, 0.5, kDeviations * e.error.x + kJump) << static_cast<int>(guidance);
        EXPECT_NEAR(e.mean.y, 0.0, kDeviations * e.error.y + kJump) << static_cast<int>(guidance) << ": B is hidden";
        EXPECT_NEAR(e.mean.z, 0.5, kDeviations * e.error.z + kJump) << static_cast<int>(guidance);
    }
    // Coverages of 1/2 are taken for independent: A 1/2, B 1/2 * 1/2, background 1/2 * 1/2.
    const Estimate biased = estimate(Guidance::kPrivate);
    std::printf("  private samples: A %.4f, B %.4f, background %.4f; standard errors %.4f %.4f %.4f\n", biased.mean.x,
                biased.mean.y, biased.mean.z, biased.error.x, biased.error.y, biased.error.z);
    EXPECT_NEAR(biased.mean.x, 0.5, kDeviations * biased.error.x + kJump);
    EXPECT_NEAR(biased.mean.y, 0.25, kDeviations * biased.error.y + kJump);
    EXPECT_NEAR(biased.mean.z, 0.25, kDeviations * biased.error.z + kJump);
    EXPECT_GT(biased.mean.y / biased.error.y, 50.0) << "no chance: B must not be seen at all";
}

TEST(GuidedSampling, ARealFrameFindsTheBiasedOneAndAcquitsTheOthers) {
    GuidedPlan plan;
    plan.settings.image.width = 64;
    plan.settings.image.height = 36;
    plan.settings.image.spp = 64;
    plan.settings.camera.fstop = 2.0;
    plan.settings.shutter.shutter = 1.0;
    plan.repeats = 12;
    const GuidedReport report = run_guided_sampling(load_scene("builtin:cubes"), plan);
    ASSERT_EQ(report.rows.size(), 5u);
    for (const GuidedRow& row : report.rows) {
        std::printf("  %-10s rms z %.2f, worst z %.1f, bias %.5f, error %.5f, %.1f tests a pixel\n", row.name.c_str(),
                    row.rms_z, row.worst_z, row.bias, row.error, row.tests_per_pixel);
        if (row.name == "private") {
            EXPECT_GT(row.rms_z, 3.0);
            EXPECT_GT(row.worst_z, 15.0);
        } else {
            // t with 11 degrees of freedom: root mean square 1.11, over some 400 blocks and channels +- 0.1.
            EXPECT_LT(row.rms_z, 1.5) << row.name;
            EXPECT_LT(row.worst_z, 8.0) << row.name;
        }
    }
    // Bounds lose no sample: the same picture from fewer tests.
    EXPECT_EQ(report.rows[0].mean.rgba, report.rows[1].mean.rgba);
    EXPECT_LT(report.rows[1].tests_per_pixel, report.rows[0].tests_per_pixel);
}

}  // namespace
}  // namespace pentaprism
