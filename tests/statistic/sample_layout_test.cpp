// The pixels of a block share strata of lens and time, so that vectors of samples can be culled whole. If their errors
// went together, blotches of the size of blocks would show: means of blocks in real frames, against free sampling,
// where each pixel has Sobol' points of its own (docs/develop/algorithms.md 9.1). bench/sample_layout.py measures the
// same on more frames (docs/develop/sample-layout.md).
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <pentaprism/scene.h>

#include "peer/posed_picture.h"
#include "support/flat_pictures.h"

namespace pentaprism {
namespace {

constexpr int kSeeds = 12;
using Pictures = std::vector<std::vector<float>>;  // by seed

struct LaidOut {
    const char* scene;
    bool defocus;
    PixelRect part;  // of 1024x768, where much blurs
    double most;     // that the variance of block means may be, over that of free sampling
};

class Look {
  public:
    explicit Look(const LaidOut& which) : part_(which.part), scene_(load_scene(which.scene)) {
        settings_.image.width = 1024;
        settings_.image.height = 768;
        settings_.image.spp = 16;
        settings_.camera.defocus = which.defocus;
        picture_ = std::make_unique<PosedPicture>(pose_picture(scene_, settings_, 24));
        greys_ = support::flat_greys(picture_->frame);
    }

    // Means of blocks of `side` pixels.
    Pictures render(Sampler sampler, VisibilityMethod visibility, int side) const {
        Pictures pictures;
        for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
            MethodSettings method = settings_.method;
            method.sampler = sampler;
            method.visibility = visibility;
            method.seed = seed;
            const SampleTable samples = make_samples(picture_->frame, settings_.image.spp, method);
            const Visibility seen(picture_->frame, samples, method, part_);
            pictures.push_back(
                support::block_means(support::flat_picture(seen, samples, greys_, part_), part_.x1 - part_.x0, side));
        }
        return pictures;
    }

  private:
    PixelRect part_;
    Scene scene_;
    RenderSettings settings_;
    std::unique_ptr<PosedPicture> picture_;
    std::vector<float> greys_;
};

// Mean over the picture of the variance over seeds; `without`: a seed that is left out, or -1.
double variance(const Pictures& pictures, int without) {
    double sum = 0;
    for (std::size_t i = 0; i < pictures[0].size(); ++i) {
        double n = 0, mean = 0, squares = 0;
        for (int seed = 0; seed < kSeeds; ++seed) {
            if (seed == without) continue;
            n += 1;
            mean += pictures[seed][i];
            squares += double{pictures[seed][i]} * pictures[seed][i];
        }
        sum += (squares - mean * mean / n) / (n - 1);
    }
    return sum / static_cast<double>(pictures[0].size());
}

// With its standard error, by leaving out each seed in turn.
struct Ratio {
    double value, error;
};
Ratio ratio(const Pictures& a, const Pictures& b) {
    double mean = 0, squares = 0;
    for (int seed = 0; seed < kSeeds; ++seed) {
        const double r = variance(a, seed) / variance(b, seed);
        mean += r / kSeeds;
        squares += r * r;
    }
    return {variance(a, -1) / variance(b, -1), std::sqrt((kSeeds - 1.0) / kSeeds * (squares - kSeeds * mean * mean))};
}

TEST(SampleLayout, BlockMeansOfFramesVaryNoMoreThanThoseOfFreePixelsAndLessUnderMotionAlone) {
    for (const LaidOut& which : {LaidOut{"builtin:fairy-forest", true, {160, 352, 288, 416}, 1.1},
                                 LaidOut{"builtin:car", false, {480, 736, 192, 320}, 0.75}}) {
        const Look look(which);
        for (const int side : {4, 8}) {
            const Pictures free = look.render(Sampler::kSobol, VisibilityMethod::kStochastic, side);
            const Ratio ours = ratio(look.render(Sampler::kStratified, VisibilityMethod::kStochastic, side), free);
            std::printf("  %s, %dx%d: %.2f +- %.2f\n", which.scene, side, side, ours.value, ours.error);
            ASSERT_LT(ours.error, 0.12) << "too few seeds to say anything";
            EXPECT_LT(ours.value - 3 * ours.error, which.most) << which.scene << ", " << side;
            // Samples that all pixels share are seen to be too much.
            const Ratio shared = ratio(look.render(Sampler::kStratified, VisibilityMethod::kAccumulation, side), free);
            std::printf("  %s, %dx%d, accumulation: %.2f +- %.2f\n", which.scene, side, side, shared.value,
                        shared.error);
            EXPECT_GT(shared.value - 3 * shared.error, which.most) << which.scene << ", " << side;
        }
    }
}

// The wings that beat there are blended: two thirds of the noise was that of thresholds drawn for each pixel without
// regard to time, and this was 1.0 for pixels and for block means.
TEST(SampleLayout, BlendedSurfacesThatMoveVaryLessThanWithThresholdsThatKnowNothingOfTime) {
    const Look look({"builtin:fairy-forest", false, {160, 352, 288, 416}, 0});
    for (const auto& [side, most] : {std::pair(1, 0.92), std::pair(4, 0.85)}) {
        const Pictures free = look.render(Sampler::kSobol, VisibilityMethod::kStochastic, side);
        const Ratio ours = ratio(look.render(Sampler::kStratified, VisibilityMethod::kStochastic, side), free);
        std::printf("  %dx%d: %.2f +- %.2f\n", side, side, ours.value, ours.error);
        EXPECT_LT(ours.value + ours.error, most) << side;
    }
}

}  // namespace
}  // namespace pentaprism
