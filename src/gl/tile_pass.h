#pragma once
// Without a geometry shader and without a framebuffer: compute shaders sort triangles into tiles of 8x8 pixels, and
// each tile looks at its own (gl/tiles.glsl). The same hits and the same counts.

#include <utility>
#include <vector>

#include "gl/pass.h"

namespace pentaprism::gl {

class TilePass : public Pass {
  public:
    static constexpr int kMostSlots = 8;  ///< samples of a pixel in a pass, which no framebuffer limits

    TilePass(Device& device, const PassData& data, const Culling& culling, int width, int height);
    void run(const Region& region, int count, bool is_first) override;

    /// Whether the frame's arrays are small enough for this device's storage blocks.
    static bool can_do(const Device& device, const Frame& frame);

  private:
    /// As gl/tiles.glsl reads it.
    struct Draw {
        std::uint32_t first_item, first_triangle, first_of_part, part, open, close, two_sided, segment, segments;
    };
    /// Draws that are sorted at once.
    struct Batch {
        std::size_t first_draw, draws;
        std::uint32_t items;
    };
    /// Tiles whose lists are made at once, and how long those are together, and the longest.
    struct TileRange {
        int from, to;
        std::uint32_t entries, longest;
    };

    void plan_draws();
    void bin(const Batch& batch, const Region& region);
    void fill(const TileRange& range);
    PixelRect tiles_longer_than(std::uint32_t length, const TileRange& range, int columns) const;
    void cover(const TileRange& range, const Region& region, int count);
    void set_tiles(const Program& program, const Region& region) const;

    PassData data_;
    const Program &bound_, &fill_, &cover_;
    std::uint32_t most_records_, most_entries_;
    std::vector<Draw> draws_;
    std::vector<Batch> batches_;
    Buffer draw_buffer_, records_, counts_, entries_;
    std::uint32_t entry_room_ = 0;
    // Of the batch that is binned.
    std::uint32_t record_count_ = 0;
    std::vector<std::uint32_t> offsets_;  // of each tile's list within its range
    std::vector<std::uint32_t> lengths_;
    std::vector<TileRange> ranges_;
};

}  // namespace pentaprism::gl
