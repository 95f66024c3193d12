#include "resolve/film.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

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

// A sample as it enters the sums: red, green, blue, alpha, and 1 for the weight.
struct Shown {
    float values[kSums];
};

// Sums of the tile's own pixels and the ring around it, before they meet other tiles'.
struct Patch {
    static constexpr int kSize = kCellSize + 2;
    std::int64_t sums[kSize][kSize][kSums] = {};
};

// For one pixel q: its samples' weighted sums for each of the up to 3x3 pixels p that they reach.
struct PixelSums {
    double total[3][3][kSums] = {};
    float run[3][3][kSums] = {};
    void flush() {
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i)
                for (int c = 0; c < kSums; ++c) {
                    total[j][i][c] += run[j][i][c];
                    run[j][i][c] = 0.0f;
                }
    }
};

}  // namespace

Film::Film(const FilmSettings& settings)
    : settings_(settings),
      reach_(filter_reach(settings.filter)),
      width_(settings.x1 - settings.x0),
      rows_(settings.band_rows + 2 * reach_ + 1),
      next_row_(settings.y0) {
    // A sample at offset s of pixel q lies at s - 1/2 + (q - p) from the middle of pixel p.
    for (int step = -1; step <= 1; ++step)
        for (int s = 0; s < 256; ++s) {
            const double weight = filter_weight(settings.filter, s / 256.0 - 0.5 + step);
            weights_[step + 1][s] = step == 0 || reach_ > 0 ? static_cast<float>(weight) : 0.0f;
        }
    pixels_.assign(static_cast<std::size_t>(width_) * rows_, Pixel{{}, std::numeric_limits<float>::infinity()});
}

Film::Pixel& Film::pixel(int x, int y) {
    return pixels_[static_cast<std::size_t>((y - settings_.y0) % rows_) * width_ + (x - settings_.x0)];
}

void Film::add(const Tile& tile, const SampleTable& samples, const Hits& hits, const TileShade& shade) {
    const int spp = samples.spp(), slots = samples.slots();
    const double share = 1.0 / spp;
    std::vector<Shown> shown(shade.colors.size() + 1);
    for (std::size_t i = 0; i < shade.colors.size(); ++i) {
        const glm::vec4& c = shade.colors[i];
        shown[i] = {{contained(c.x), contained(c.y), contained(c.z), 1.0f, 1.0f}};
    }
    const std::size_t background = shade.colors.size();
    shown[background] = {{contained(settings_.background.x), contained(settings_.background.y),
                          contained(settings_.background.z), 0.0f, 1.0f}};

    const auto in_picture = [&](int x, int y) {
        return x >= settings_.x0 && x < settings_.x1 && y >= settings_.y0 && y < settings_.y1;
    };
    Patch patch;
    SampleOrder order;
    const int step0 = -reach_, step1 = reach_;
    for (int by = tile.y0 / kBlockSize; by * kBlockSize < tile.y1; ++by)
        for (int bx = tile.x0 / kBlockSize; bx * kBlockSize < tile.x1; ++bx) {
            order.read(samples, bx, by);
            const auto vectors = samples.block(bx, by);
            const int block = (by % kCellBlocks) * kCellBlocks + bx % kCellBlocks;
            const std::size_t first = static_cast<std::size_t>(block) * slots * kLanes;
            for (int lane = 0; lane < kLanes; ++lane) {
                const int column = lane % kBlockSize, row = lane / kBlockSize;
                const int qx = bx * kBlockSize + column, qy = by * kBlockSize + row;
                if (qx < tile.x0 || qx >= tile.x1 || qy < tile.y0 || qy >= tile.y1) continue;
                const std::uint16_t* slot = order.slots(lane);
                PixelSums sums;
                float depth = std::numeric_limits<float>::infinity();
                for (int index = 0; index < spp; ++index) {
                    const std::size_t at = first + static_cast<std::size_t>(slot[index]) * kLanes + lane;
                    const SampleVector& vector = vectors[slot[index]];
                    const int sx = static_cast<int>((vector.x[lane] - static_cast<float>(column)) * 256.0f) & 255;
                    const int sy = static_cast<int>((-vector.y[lane] - static_cast<float>(row)) * 256.0f) & 255;
                    const std::uint32_t point = shade.point_of_sample[at];
                    const Shown& value = shown[point == kBackground ? background : point];
                    if (point != kBackground) depth = std::min(depth, hits.depth[at]);
                    // q - p runs against p - q: sums[j][i] is pixel p = q + (i - 1, j - 1).
                    for (int j = step0; j <= step1; ++j)
                        for (int i = step0; i <= step1; ++i) {
                            const float weight = weights_[1 - i][sx] * weights_[1 - j][sy];
                            float* run = sums.run[j + 1][i + 1];
                            for (int c = 0; c < kSums; ++c) run[c] += weight * value.values[c];
                        }
                    if ((index + 1) % kFloatRun == 0) sums.flush();
                }
                sums.flush();
                for (int j = step0; j <= step1; ++j)
                    for (int i = step0; i <= step1; ++i)
                        for (int c = 0; c < kSums; ++c)
                            patch.sums[qy + j - tile.y0 + 1][qx + i - tile.x0 + 1][c] +=
                                to_fixed(sums.total[j + 1][i + 1][c] * share);
                if (in_picture(qx, qy)) pixel(qx, qy).depth = depth;  // a pixel belongs to one tile
            }
        }

    // Pixels within reach of the tile's border are shared with other tiles.
    for (int y = std::max(tile.y0 - reach_, settings_.y0); y < std::min(tile.y1 + reach_, settings_.y1); ++y)
        for (int x = std::max(tile.x0 - reach_, settings_.x0); x < std::min(tile.x1 + reach_, settings_.x1); ++x) {
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
