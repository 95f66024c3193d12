#pragma once
// Experiments: questions about sampling that are easier shown than said.

#include <cstdint>
#include <pentaprism/render.h>
#include <string>
#include <vector>

namespace pentaprism {

/// May samples be placed only where the bounds of a triangle say that it can be hit? (Wu 2013 leaves that as future
/// work.) Ways to use such bounds, on one frame in flat colours without textures and masks, with a round aperture.
struct GuidedPlan {
    RenderSettings settings;  ///< image.width and height, image.spp from 32: samples of a pixel and estimator
    double frame = 0.0;
    int repeats = 8;  ///< independent pictures of each estimator, from 2; the truth has 4 times as many
};

/// One estimator's pictures against the truth, over blocks of 4 x 4 pixels. z: the difference of the means over its
/// standard error; without bias its root mean square is about 1.
struct GuidedRow {
    std::string name, description;
    double tests_per_pixel = 0.0;  ///< exact tests
    double error = 0.0;            ///< of one picture: root mean square over pixels and channels
    double bias = 0.0;  ///< of its expectation: the same with what noise explains taken off, 0 if nothing is left
    double rms_z = 0.0, worst_z = 0.0;
    Picture mean;  ///< over the repeats
};

struct GuidedReport {
    int width = 0, height = 0, blocks = 0;
    Picture truth;
    std::vector<GuidedRow> rows;  ///< "unguided", "enumerated", "private", "strata", "traced"
};

/// Throws Error(kUsage) for a plan without meaning; Error(kRender) "interrupted" when `progress` returns false.
GuidedReport run_guided_sampling(const Scene& scene, const GuidedPlan& plan, const Progress& progress = {});

/// All of it in one picture: above the truth and the means of the estimators "private", "strata" and "traced", below
/// their differences from the truth, 8 times enlarged (grey: none). Each pixel is `zoom` x `zoom`.
Picture guided_picture(const GuidedReport& report, int zoom);

}  // namespace pentaprism
