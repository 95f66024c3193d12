#include "resolve/tile_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "resolve/filter.h"
#include "resolve/filter_block.h"
#include "resolve/sample_place.h"

namespace pentaprism {
namespace {

constexpr int kSums = BlockSums::kSums;
constexpr float kBrightest = 0x1p20f;  // keeps 9 pixels' sums of 2^52 each far inside 64 bits
constexpr double kUnit = 0x1p32;

std::int64_t to_fixed(double x) {
    return std::llrint(std::clamp(x, -2.0 * kBrightest, 2.0 * kBrightest) * kUnit);
}

float contained(float x) {
    return std::isfinite(x) ? std::clamp(x, -kBrightest, kBrightest) : 0.0f;
}

// A sample as it enters the sums.
Float4 sample_of(const glm::vec3& color, float alpha) {
    return Float4{contained(color.x), contained(color.y), contained(color.z), alpha};
}

// Adds a block's sums to those of the pixels it reaches.
void add_block(const BlockSums& block, int bx, int by, TileSums& sums) {
    const Tile& tile = sums.tile;
    const int x0 = bx * kBlockSize, y0 = by * kBlockSize, reach = sums.reach;
    const int columns = std::min(kBlockSize, tile.x1 - x0), rows = std::min(kBlockSize, tile.y1 - y0);
    // Sums of whole numbers: in any order. Those of one kind lie side by side here.
    std::int64_t around[kSums][kBlockSize + 2][kBlockSize + 4] = {};
    for (int j = 1 - reach; j <= 1 + reach; ++j)
        for (int i = 1 - reach; i <= 1 + reach; ++i)
            for (int c = 0; c < kSums; ++c)
                for (int row = 0; row < rows; ++row) {
                    const std::int64_t* from = &block.fixed[j][i][c][row * kBlockSize];
                    std::int64_t* to = &around[c][row + j][i];
                    if (columns == kBlockSize)
                        for (int column = 0; column < kBlockSize; ++column) to[column] += from[column];
                    else
                        for (int column = 0; column < columns; ++column) to[column] += from[column];
                }
    for (int row = 1 - reach; row < rows + 1 + reach; ++row)
        for (int column = 1 - reach; column < columns + 1 + reach; ++column) {
            PixelSums& to = sums.at(x0 + column - 1, y0 + row - 1);
            for (int c = 0; c < kSums; ++c) to[c] += around[c][row][column];
        }
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
            sums.depth[sums.own(x0 + column, y0 + row)] = block.depth[row * kBlockSize + column];
}

}  // namespace

void TileSums::start(const Tile& of, int ring, int channels) {
    tile = of;
    reach = ring;
    const std::size_t pixels = static_cast<std::size_t>(width()) * height();
    sums.assign(static_cast<std::size_t>(width() + 2 * reach) * (height() + 2 * reach), PixelSums{});
    depth.assign(pixels, std::numeric_limits<float>::infinity());
    aovs.assign(pixels * channels, 0.0f);
}

TileFilter::TileFilter(Filter filter, const glm::vec3& background)
    : reach_(filter_reach(filter)), background_(background) {
    // A sample at offset s of pixel q lies at s - 1/2 + (q - p) from the middle of pixel p; lane i is p = q + i - 1.
    for (int s = 0; s < 256; ++s) {
        weights_[s] = splat(0.0f);
        for (int i = 1 - reach_; i <= 1 + reach_; ++i)
            weights_[s][i] = static_cast<float>(filter_weight(filter, s / 256.0 - 0.5 - (i - 1)));
    }
}

void TileFilter::add_sample(const SubPixel& at, const glm::vec4& color, double weight, TileSums& sums) const {
    const Float4 value = sample_of(glm::vec3(color), color.w);
    const int px = at.x >> 8, py = at.y >> 8;
    const Float4 &across = weights_[at.x & 255], &down = weights_[at.y & 255];
    for (int j = -reach_; j <= reach_; ++j)
        for (int i = -reach_; i <= reach_; ++i) {
            const double share = weight * across[i + 1] * down[j + 1];
            PixelSums& to = sums.at(px + i, py + j);
            for (int c = 0; c < 4; ++c) to[c] += to_fixed(share * value[c]);
            to[4] += to_fixed(share);
        }
}

void TileFilter::add(const SampleTable& samples, const Hits& hits, const TileShade& shade, TileSums& sums) const {
    // Points, then the background.
    const std::size_t background = shade.colors.size();
    std::vector<Float4> shown(background + 1, sample_of(background_, 0.0f));
    for (std::size_t i = 0; i < background; ++i) shown[i] = sample_of(glm::vec3(shade.colors[i]), shade.colors[i].w);

    const Tile& tile = sums.tile;
    const FilterBlock filter = filter_block();
    BlockSums block;
    for (int by = tile.y0 / kBlockSize; by * kBlockSize < tile.y1; ++by)
        for (int bx = tile.x0 / kBlockSize; bx * kBlockSize < tile.x1; ++bx) {
            if (!tile.wants(bx, by)) continue;
            const std::size_t first = hits.first(bx, by);
            filter({samples.block(bx, by).data(), &shade.point_of_sample[first], &hits.depth[first], samples.slots(),
                    shown.data(), static_cast<std::uint32_t>(background), weights_.data(), 1.0 / samples.spp()},
                   block);
            add_block(block, bx, by, sums);
        }
}

}  // namespace pentaprism
