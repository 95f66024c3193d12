#include "resolve/tile_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "resolve/filter.h"
#include "resolve/sample_place.h"
#include "shade/sample_order.h"

namespace pentaprism {
namespace {

constexpr int kSums = 5;
constexpr float kBrightest = 0x1p20f;  // keeps 9 pixels' sums of 2^52 each far inside 64 bits
constexpr double kUnit = 0x1p32;
constexpr int kFloatRun = 32;  // samples added in float before they are added in double

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

// For one pixel q: its samples' weighted sums for each of the up to 3x3 pixels p = q + (i - 1, j - 1) that they reach.
struct FilteredPixel {
    double total[3][3][kSums] = {};
    Float4 colors[3][3] = {};  // red, green, blue, alpha
    Float4 weights[3] = {};    // lane i

    void add(Float4 value, Float4 across, Float4 down) {
        for (int j = 0; j < 3; ++j) {
            const Float4 row = across * splat(down[j]);
            weights[j] += row;
            for (int i = 0; i < 3; ++i) colors[j][i] += splat(row[i]) * value;
        }
    }
    void flush() {
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < 3; ++i) {
                for (int c = 0; c < 4; ++c) total[j][i][c] += colors[j][i][c];
                total[j][i][4] += weights[j][i];
                colors[j][i] = splat(0.0f);
            }
            weights[j] = splat(0.0f);
        }
    }
    void add_to(TileSums& sums, int x, int y, double share) const {
        for (int j = -sums.reach; j <= sums.reach; ++j)
            for (int i = -sums.reach; i <= sums.reach; ++i) {
                PixelSums& to = sums.at(x + i, y + j);
                for (int c = 0; c < kSums; ++c) to[c] += to_fixed(total[j + 1][i + 1][c] * share);
            }
    }
};

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
    const double share = 1.0 / samples.spp();
    SampleOrder order;
    for (int by = tile.y0 / kBlockSize; by * kBlockSize < tile.y1; ++by)
        for (int bx = tile.x0 / kBlockSize; bx * kBlockSize < tile.x1; ++bx) {
            if (!tile.wants(bx, by)) continue;
            order.read(samples, bx, by);
            const std::span<const SampleVector> vectors = samples.block(bx, by);
            for (int lane = 0; lane < kLanes; ++lane) {
                const int qx = bx * kBlockSize + lane % kBlockSize, qy = by * kBlockSize + lane / kBlockSize;
                if (qx < tile.x0 || qx >= tile.x1 || qy < tile.y0 || qy >= tile.y1) continue;
                FilteredPixel pixel;
                float depth = std::numeric_limits<float>::infinity();
                for (int index = 0; index < samples.spp(); ++index) {
                    const int slot = order.slots(lane)[index];
                    const std::size_t at = place_in_hits(bx, by, slot, lane, samples.slots());
                    const std::uint32_t point = shade.point_of_sample[at];
                    if (point != kBackground) depth = std::min(depth, hits.depth[at]);
                    const auto [sx, sy] = place_in_pixel(vectors[slot], lane);
                    pixel.add(shown[point == kBackground ? background : point], weights_[sx], weights_[sy]);
                    if ((index + 1) % kFloatRun == 0) pixel.flush();
                }
                pixel.flush();
                pixel.add_to(sums, qx, qy, share);
                sums.depth[sums.own(qx, qy)] = depth;
            }
        }
}

}  // namespace pentaprism
