#include "resolve/film.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/parallel.h"

namespace pentaprism {
namespace {

constexpr std::size_t kRowsAtOnce = 16;  // by one thread

}  // namespace

Film::Film(const FilmSettings& settings)
    : settings_(settings),
      width_(settings.x1 - settings.x0),
      rows_(settings.band_rows + 2 * settings.reach + 1),
      next_row_(settings.y0) {
    // By all threads: most of this time is the system's, which hands out memory.
    pixels_.resize(static_cast<std::size_t>(width_) * rows_);
    parallel_ranges(rows_, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
        std::fill(pixels_.begin() + begin * width_, pixels_.begin() + end * width_, kNothing);
    });
}

Film::Pixel& Film::pixel(int x, int y) {
    return pixels_[static_cast<std::size_t>((y - settings_.y0) % rows_) * width_ + (x - settings_.x0)];
}

void Film::add(const TileSums& from) {
    const Tile& tile = from.tile;
    const int reach = settings_.reach;
    const int x0 = std::max(tile.x0 - reach, settings_.x0), x1 = std::min(tile.x1 + reach, settings_.x1);
    const int y0 = std::max(tile.y0 - reach, settings_.y0), y1 = std::min(tile.y1 + reach, settings_.y1);
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
            // Pixels within reach of the tile's border are shared with other tiles.
            const bool shared =
                x < tile.x0 + reach || x >= tile.x1 - reach || y < tile.y0 + reach || y >= tile.y1 - reach;
            Pixel& to = pixel(x, y);
            const PixelSums& sums = from.at(x, y);
            for (std::size_t c = 0; c < sums.size(); ++c) {
                if (shared)
                    std::atomic_ref<std::int64_t>(to.sums[c]).fetch_add(sums[c], std::memory_order_relaxed);
                else
                    to.sums[c] += sums[c];
            }
            const bool own = x >= tile.x0 && x < tile.x1 && y >= tile.y0 && y < tile.y1;
            if (own) to.depth = from.depth[from.own(x, y)];  // a pixel belongs to one tile
        }
}

PixelRows Film::take_rows(int rendered_to, bool last, int most) {
    const int whole = std::clamp(last ? settings_.y1 : rendered_to - settings_.reach, next_row_, settings_.y1);
    const int first = next_row_, count = std::min(whole - first, most);
    const std::size_t n = static_cast<std::size_t>(count) * width_;
    rgba_.resize(4 * n);
    z_.resize(n);
    const double scale = std::exp2(settings_.exposure);
    parallel_ranges(count, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row)
            for (int column = 0; column < width_; ++column) {
                const std::size_t i = row * width_ + column;
                Pixel& from = pixel(settings_.x0 + column, first + static_cast<int>(row));
                const double weight = static_cast<double>(from.sums[4]);
                const double divisor = weight > 0.0 ? 1.0 / weight : 0.0;
                for (int c = 0; c < 3; ++c) rgba_[4 * i + c] = static_cast<float>(from.sums[c] * divisor * scale);
                rgba_[4 * i + 3] = static_cast<float>(from.sums[3] * divisor);
                z_[i] = from.depth;
                from = kNothing;
            }
    });
    next_row_ = first + count;
    return {first, count, width_, rgba_, z_};
}

}  // namespace pentaprism
