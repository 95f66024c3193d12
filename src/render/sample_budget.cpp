#include "render/sample_budget.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resolve/sample_order.h"
#include "resolve/sample_place.h"
#include "sample/net.h"

namespace pentaprism {
namespace {

// Squared errors fall as N^-1 with random samples and about N^-1.4 with the others where both blurs count
// (docs/learn/sample-patterns.md: error as N^-0.7).
constexpr double kRandomSlope = 1.0, kNetSlope = 1.4;
constexpr double kEvenSpp = 64;  // a block that needs as many for the target gets them
// What a pass over a tile costs, in samples: measured (docs/learn/adaptive-sampling.md).
constexpr double kPassCost = 2048, kPointCost = 32;
constexpr double kDarkest = 1.0 / 64;  // below, errors count as there

std::uint64_t bit_of_block(int bx, int by) {
    return std::uint64_t{1} << (by % kCellBlocks * kCellBlocks + bx % kCellBlocks);
}

}  // namespace

SampleBudget::SampleBudget(const ImageSettings& image, Sampler sampler, const glm::vec3& background)
    : target_(image.target_error.value_or(0.0)),
      brightness_(std::exp2(image.exposure)),
      slope_(sampler == Sampler::kIndependent ? kRandomSlope : kNetSlope),
      background_(background),
      columns_((image.width + kBlockSize - 1) / kBlockSize),
      rows_((image.height + kBlockSize - 1) / kBlockSize),
      errors_(static_cast<std::size_t>(columns_) * rows_, -1.0f),
      points_(cell_index(0, (rows_ + kCellBlocks - 1) / kCellBlocks), 0) {
    for (int spp = image.spp; spp < image.max_spp; spp *= 2) levels_.push_back(spp);
    levels_.push_back(std::max(image.spp, image.max_spp));
}

std::uint32_t SampleBudget::pilot_seed(std::uint32_t seed) {
    return mix(seed ^ 0x50696c6fu);
}

// The mean over the picture of v * N^-p, at a given sum of the N, is least where N is in proportion to v^(1 / (p + 1)).
std::size_t SampleBudget::level_for(double squared_error) const {
    const double for_target = std::pow(squared_error / (target_ * target_), 1.0 / slope_);
    const double wanted = kEvenSpp * std::pow(for_target / kEvenSpp, slope_ / (slope_ + 1.0));
    std::size_t level = 0;
    while (level + 1 < levels_.size() && wanted > levels_[level]) ++level;
    return level;
}

std::vector<Tile> SampleBudget::tiles_to_know(std::span<const Tile> tiles, std::span<const Tile> all) const {
    std::vector<std::uint64_t> wanted(points_.size(), 0);
    for (const Tile& tile : tiles) {
        const int bx0 = tile.cell_x() * kCellBlocks, bx1 = bx0 + kCellBlocks;
        const int by0 = tile.cell_y() * kCellBlocks, by1 = by0 + kCellBlocks;
        for (int by = std::max(by0 - 1, 0); by <= std::min(by1, rows_ - 1); ++by)
            for (int bx = std::max(bx0 - 1, 0); bx <= std::min(bx1, columns_ - 1); ++bx)
                wanted[cell_index(bx / kCellBlocks, by / kCellBlocks)] |= bit_of_block(bx, by);
    }
    std::vector<Tile> out;
    for (Tile tile : all) {
        tile.blocks = wanted[cell_index(tile.cell_x(), tile.cell_y())];
        if (tile.blocks != 0) out.push_back(tile);
    }
    return out;
}

void SampleBudget::note(const Tile& tile, const SampleTable& pilot, const Hits& hits, const TileShade& shade) {
    points_[cell_index(tile.cell_x(), tile.cell_y())] = static_cast<int>(shade.colors.size());
    for (int by = tile.y0 / kBlockSize; by * kBlockSize < tile.y1; ++by)
        for (int bx = tile.x0 / kBlockSize; bx * kBlockSize < tile.x1; ++bx)
            if (tile.wants(bx, by))
                errors_[static_cast<std::size_t>(by) * columns_ + bx] =
                    static_cast<float>(error_of_block(bx, by, tile, pilot, hits, shade));
}

std::vector<std::uint64_t> SampleBudget::share_out(const Tile& tile) const {
    std::vector<std::uint64_t> wanted(levels_.size(), 0), blocks(levels_.size(), 0);
    std::vector<int> counts(levels_.size(), 0);
    const int bx0 = tile.cell_x() * kCellBlocks, by0 = tile.cell_y() * kCellBlocks;
    for (int by = by0; by < std::min(by0 + kCellBlocks, rows_); ++by)
        for (int bx = bx0; bx < std::min(bx0 + kCellBlocks, columns_); ++bx) {
            const std::size_t level = level_for(smooth_error(bx, by));
            wanted[level] |= bit_of_block(bx, by);
            ++counts[level];
        }
    const double pass_cost = kPassCost + kPointCost * points_[cell_index(tile.cell_x(), tile.cell_y())];
    const std::vector<std::size_t> taken = levels_to_take(counts, pass_cost);
    for (std::size_t level = 0; level < levels_.size(); ++level) blocks[taken[level]] |= wanted[level];
    return blocks;
}

// From the highest down: cheapest[l] is that of the blocks of levels 0 to l if l is taken, which serves them down to
// below[l] + 1.
std::vector<std::size_t> SampleBudget::levels_to_take(std::span<const int> blocks, double pass_cost) const {
    const int count = static_cast<int>(levels_.size());
    std::vector<double> cheapest(count);
    std::vector<int> below(count, -1);
    for (int level = 0; level < count; ++level) {
        double samples = 0.0;
        cheapest[level] = std::numeric_limits<double>::infinity();
        for (int next = level - 1;; --next) {  // the next that is taken
            samples += static_cast<double>(blocks[next + 1]) * kLanes * levels_[level];
            const double cost = (samples > 0.0 ? samples + pass_cost : 0.0) + (next >= 0 ? cheapest[next] : 0.0);
            if (cost < cheapest[level]) cheapest[level] = cost, below[level] = next;
            if (next < 0) break;
        }
    }
    std::vector<std::size_t> taken(count);
    for (int level = count - 1, serves = -1; level >= 0; --level) {
        if (serves < 0 || level <= below[serves]) serves = level;
        taken[level] = serves;
    }
    return taken;
}

// The mean of a block and those around it: the pilot's samples in one block are few.
double SampleBudget::smooth_error(int bx, int by) const {
    double sum = 0.0;
    int count = 0;
    for (int y = std::max(by - 1, 0); y <= std::min(by + 1, rows_ - 1); ++y)
        for (int x = std::max(bx - 1, 0); x <= std::min(bx + 1, columns_ - 1); ++x) {
            const float error = errors_[static_cast<std::size_t>(y) * columns_ + x];
            if (error < 0.0f) continue;
            sum += error;
            ++count;
        }
    return count > 0 ? sum / count : 0.0;
}

// Mean variance of one sample in the block's pixels, of the root of each colour, which is about how it is displayed: to
// first order the colour's variance over four times its mean, which is the whole block's.
double SampleBudget::error_of_block(int bx, int by, const Tile& tile, const SampleTable& pilot, const Hits& hits,
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
            const std::size_t at = hits.entry(px, py, order.slots(lane)[index]);
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
