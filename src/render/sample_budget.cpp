#include "render/sample_budget.h"

#include <algorithm>
#include <cmath>

#include "resolve/sample_place.h"
#include "sample/net.h"
#include "shade/sample_order.h"

namespace pentaprism {
namespace {

// A quarter of the least that is shown, but enough for 64 in a block.
constexpr int kLeastPilot = 4;
constexpr int kMostPilot = 64;
// Squared errors fall as N^-1 with random samples and about N^-1.4 with the others where both blurs count
// (docs/learn/sample-patterns.md: error as N^-0.7).
constexpr double kRandomSlope = 1.0, kNetSlope = 1.4;
constexpr double kDarkest = 1.0 / 64;  // below, errors count as there

}  // namespace

SampleBudget::SampleBudget(const ImageSettings& image, Sampler sampler, const glm::vec3& background)
    : pilot_(std::clamp(image.spp / 4, kLeastPilot, kMostPilot)),
      target_(image.target_error.value_or(0.0)),
      brightness_(std::exp2(image.exposure)),
      slope_(sampler == Sampler::kIndependent ? kRandomSlope : kNetSlope),
      background_(background) {
    for (int spp = image.spp; spp < image.max_spp; spp *= 2) levels_.push_back(spp);
    levels_.push_back(std::max(image.spp, image.max_spp));
}

std::uint32_t SampleBudget::pilot_seed(std::uint32_t seed) {
    return mix(seed ^ 0x50696c6fu);
}

std::size_t SampleBudget::level_for(double squared_error) const {
    std::size_t level = 0;
    while (level + 1 < levels_.size() && squared_error > target_ * target_ * std::pow(levels_[level], slope_)) ++level;
    return level;
}

std::vector<std::uint64_t> SampleBudget::share_out(const Tile& tile, const SampleTable& pilot,
                                                   const TileShade& shade) const {
    std::vector<std::uint64_t> blocks(levels_.size(), 0);
    for (int by = tile.y0 / kBlockSize; by * kBlockSize < tile.y1; ++by)
        for (int bx = tile.x0 / kBlockSize; bx * kBlockSize < tile.x1; ++bx) {
            const std::size_t level = level_for(error_of_block(bx, by, tile, pilot, shade));
            blocks[level] |= std::uint64_t{1} << (by % kCellBlocks * kCellBlocks + bx % kCellBlocks);
        }
    return blocks;
}

// Mean variance of one sample in the block's pixels, of the root of each colour, which is about how it is displayed: to
// first order the colour's variance over four times its mean, which is the whole block's.
double SampleBudget::error_of_block(int bx, int by, const Tile& tile, const SampleTable& pilot,
                                    const TileShade& shade) const {
    SampleOrder order;
    order.read(pilot, bx, by);
    glm::dvec3 means(0.0), squares(0.0);
    int pixels = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
        const int px = bx * kBlockSize + lane % kBlockSize, py = by * kBlockSize + lane / kBlockSize;
        if (px >= tile.x1 || py >= tile.y1) continue;
        glm::dvec3 mean(0.0), off_squared(0.0);  // Welford's
        for (int index = 0; index < pilot.spp(); ++index) {
            const std::size_t at = place_in_hits(bx, by, order.slots(lane)[index], lane, pilot.slots());
            const std::uint32_t point = shade.point_of_sample[at];
            const glm::dvec3 color = point == kBackground ? background_ : glm::dvec3(shade.colors[point]);
            const glm::dvec3 off = color - mean;
            mean += off / (index + 1.0);
            off_squared += off * (color - mean);
        }
        means += mean;
        squares += off_squared / (pilot.spp() - 1.0);
        ++pixels;
    }
    double error = 0.0;
    for (int c = 0; c < 3; ++c) {
        const double mean = means[c] / pixels * brightness_;
        const double variance = squares[c] / pixels * brightness_ * brightness_;
        error += variance / (4.0 * std::max(mean, kDarkest)) / 3.0;
    }
    return error;
}

}  // namespace pentaprism
