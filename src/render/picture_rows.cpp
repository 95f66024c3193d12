#include "render/picture_rows.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"

namespace pentaprism {
namespace {

// Rows of a band of tiles. All threads wait at its end for the last tile, so it holds many for each of them; but its
// film stays small, however many threads and whatever the width. The bytes of a file with output variables depend on
// the bands, so these do not depend on the threads then.
int band_rows(const PixelRect& rect, bool has_aovs) {
    constexpr int kFilmPixels = 1 << 23, kTilesForEachThread = 128, kTilesWithAovs = 512;
    const int width = std::max(1, rect.x1 - rect.x0), tiles_a_row = (width + kCellSize - 1) / kCellSize;
    const int tiles = has_aovs ? kTilesWithAovs : kTilesForEachThread * thread_count();
    const int picture = (rect.y1 - rect.y0 + 2 * kCellSize - 1) / kCellSize + 1;
    const int most = std::max(1, kFilmPixels / width / kCellSize);
    return std::min({(tiles + tiles_a_row - 1) / tiles_a_row, picture, most}) * kCellSize;
}

}  // namespace

PixelRect delivered_part(const FrameInfo& info) {
    return {info.x0, info.x1, info.y0, info.y1};
}

PixelRect rendered_part(const FrameInfo& info, int reach) {
    // To the end of a block: what a block's pixels decide together must not depend on a crop.
    const auto end = [&](int last, int size) {
        return std::min(size, (last + reach + kBlockSize - 1) / kBlockSize * kBlockSize);
    };
    return {std::max(0, info.x0 - reach), end(info.x1, info.width), std::max(0, info.y0 - reach),
            end(info.y1, info.height)};
}

PictureRows::PictureRows(const FrameInfo& info, int reach, double exposure, RowSink& sink)
    : part_(delivered_part(info)),
      has_aovs_(!info.aovs.empty()),
      band_rows_(band_rows(part_, has_aovs_)),
      film_({part_.x0, part_.y0, part_.x1, part_.y1, band_rows_, reach, exposure}),
      aovs_(channel_count(info.aovs), part_.x0, part_.x1, band_rows_ + 2 * reach + 1),
      sink_(sink) {
    sink_.begin(info);
}

void PictureRows::assemble(std::span<const Tile> tiles,
                           const std::function<void(std::size_t, std::size_t)>& add_tiles) {
    for (std::size_t first = 0; first < tiles.size();) {
        const int band_end = tiles[first].y0 + band_rows_;
        std::size_t last = first;
        while (last < tiles.size() && tiles[last].y1 <= band_end) ++last;
        add_tiles(first, last);
        deliver(tiles[last - 1].y1, last == tiles.size());
        first = last;
    }
}

void PictureRows::add(const TileSums& tile) {
    film_.add(tile);
    aovs_.add(tile, part_.y0, part_.y1);
}

// In pieces, so that what is made of the film does not take as much memory again. With output variables all at once: a
// file holds them in the order in which they come.
void PictureRows::deliver(int rendered_to, bool last) {
    constexpr int kPiece = 256;
    for (;;) {
        PixelRows rows = film_.take_rows(rendered_to, last, has_aovs_ ? std::numeric_limits<int>::max() : kPiece);
        if (rows.count == 0) return;
        rows.aovs = aovs_.rows(rows.y0, rows.count);
        sink_.rows(rows);
    }
}

}  // namespace pentaprism
