#include "resolve/film.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <span>

#include "resolve/filter.h"
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
struct PixelSums {
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
};

// Offsets of a sample in its pixel, from the top left corner, times 256: exact.
struct Offsets {
    int x, y;
};

Offsets offsets(const SampleVector& vector, int lane) {
    // Pixels lie at whole numbers from the middle of their cell.
    return {static_cast<int>(vector.x[lane] * 256.0f) & 255, static_cast<int>(-vector.y[lane] * 256.0f) & 255};
}

std::size_t hit_index(int bx, int by, int slot, int lane, int slots) {
    const int block = by % kCellBlocks * kCellBlocks + bx % kCellBlocks;
    return (static_cast<std::size_t>(block) * slots + slot) * kLanes + lane;
}

}  // namespace

// Sums of the tile's own pixels and the ring around it, before they meet other tiles'.
struct Film::Patch {
    static constexpr int kSize = kCellSize + 2;
    std::int64_t sums[kSize][kSize][kSums] = {};

    // x, y: pixel in the tile.
    void add(int x, int y, int reach, const PixelSums& from, double share) {
        for (int j = -reach; j <= reach; ++j)
            for (int i = -reach; i <= reach; ++i)
                for (int c = 0; c < kSums; ++c)
                    sums[y + j + 1][x + i + 1][c] += to_fixed(from.total[j + 1][i + 1][c] * share);
    }
};

Film::Film(const FilmSettings& settings)
    : settings_(settings),
      reach_(filter_reach(settings.filter)),
      width_(settings.x1 - settings.x0),
      rows_(settings.band_rows + 2 * reach_ + 1),
      next_row_(settings.y0) {
    // A sample at offset s of pixel q lies at s - 1/2 + (q - p) from the middle of pixel p; lane i is p = q + i - 1.
    for (int s = 0; s < 256; ++s) {
        weights_[s] = splat(0.0f);
        for (int i = 1 - reach_; i <= 1 + reach_; ++i)
            weights_[s][i] = static_cast<float>(filter_weight(settings.filter, s / 256.0 - 0.5 - (i - 1)));
    }
    pixels_.assign(static_cast<std::size_t>(width_) * rows_, Pixel{{}, std::numeric_limits<float>::infinity()});
}

Film::Pixel& Film::pixel(int x, int y) {
    return pixels_[static_cast<std::size_t>((y - settings_.y0) % rows_) * width_ + (x - settings_.x0)];
}

void Film::add(const Tile& tile, const SampleTable& samples, const Hits& hits, const TileShade& shade) {
    // Points, then the background.
    const std::size_t background = shade.colors.size();
    std::vector<Float4> shown(background + 1, sample_of(settings_.background, 0.0f));
    for (std::size_t i = 0; i < background; ++i) shown[i] = sample_of(glm::vec3(shade.colors[i]), shade.colors[i].w);

    const double share = 1.0 / samples.spp();
    Patch patch;
    SampleOrder order;
    for (int by = tile.y0 / kBlockSize; by * kBlockSize < tile.y1; ++by)
        for (int bx = tile.x0 / kBlockSize; bx * kBlockSize < tile.x1; ++bx) {
            order.read(samples, bx, by);
            const std::span<const SampleVector> vectors = samples.block(bx, by);
            for (int lane = 0; lane < kLanes; ++lane) {
                const int qx = bx * kBlockSize + lane % kBlockSize, qy = by * kBlockSize + lane / kBlockSize;
                if (qx < tile.x0 || qx >= tile.x1 || qy < tile.y0 || qy >= tile.y1) continue;
                PixelSums sums;
                float depth = std::numeric_limits<float>::infinity();
                for (int index = 0; index < samples.spp(); ++index) {
                    const int slot = order.slots(lane)[index];
                    const std::size_t at = hit_index(bx, by, slot, lane, samples.slots());
                    const std::uint32_t point = shade.point_of_sample[at];
                    if (point != kBackground) depth = std::min(depth, hits.depth[at]);
                    const auto [sx, sy] = offsets(vectors[slot], lane);
                    sums.add(shown[point == kBackground ? background : point], weights_[sx], weights_[sy]);
                    if ((index + 1) % kFloatRun == 0) sums.flush();
                }
                sums.flush();
                patch.add(qx - tile.x0, qy - tile.y0, reach_, sums, share);
                if (delivers(qx, qy)) pixel(qx, qy).depth = depth;  // a pixel belongs to one tile
            }
        }
    merge(tile, patch);
}

void Film::merge(const Tile& tile, const Patch& patch) {
    const int x0 = std::max(tile.x0 - reach_, settings_.x0), x1 = std::min(tile.x1 + reach_, settings_.x1);
    const int y0 = std::max(tile.y0 - reach_, settings_.y0), y1 = std::min(tile.y1 + reach_, settings_.y1);
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
            // Pixels within reach of the tile's border are shared with other tiles.
            const bool shared =
                x < tile.x0 + reach_ || x >= tile.x1 - reach_ || y < tile.y0 + reach_ || y >= tile.y1 - reach_;
            Pixel& to = pixel(x, y);
            const std::int64_t* from = patch.sums[y - tile.y0 + 1][x - tile.x0 + 1];
            for (int c = 0; c < kSums; ++c) {
                if (shared)
                    std::atomic_ref<std::int64_t>(to.sums[c]).fetch_add(from[c], std::memory_order_relaxed);
                else
                    to.sums[c] += from[c];
            }
        }
}

PixelRows Film::take_rows(int rendered_to, bool last) {
    const int end = std::clamp(last ? settings_.y1 : rendered_to - reach_, next_row_, settings_.y1);
    const int first = next_row_, count = end - first;
    const std::size_t n = static_cast<std::size_t>(count) * width_;
    rgba_.resize(4 * n);
    z_.resize(n);
    const double scale = std::exp2(settings_.exposure);
    std::size_t i = 0;
    for (int y = first; y < end; ++y)
        for (int x = settings_.x0; x < settings_.x1; ++x, ++i) {
            Pixel& from = pixel(x, y);
            const double weight = static_cast<double>(from.sums[4]);
            const double divisor = weight > 0.0 ? 1.0 / weight : 0.0;
            for (int c = 0; c < 3; ++c) rgba_[4 * i + c] = static_cast<float>(from.sums[c] * divisor * scale);
            rgba_[4 * i + 3] = static_cast<float>(from.sums[3] * divisor);
            z_[i] = from.depth;
            from = Pixel{{}, std::numeric_limits<float>::infinity()};
        }
    next_row_ = end;
    return {first, count, width_, rgba_, z_};
}

}  // namespace pentaprism
