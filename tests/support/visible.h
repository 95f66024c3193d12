#pragma once
// What every sample of a frame sees, by pixel and sample index, through the whole visibility stage.

#include <vector>

#include "render/visibility.h"

namespace pentaprism::support {

struct Seen {
    std::uint32_t triangle = kNoTriangle;
    float depth = 0;
    bool hit() const { return triangle != kNoTriangle; }
    bool operator==(const Seen&) const = default;
};

class Visible {
  public:
    Visible(const Frame& frame, const SampleTable& samples, const char* culling = "auto")
        : width_(frame.view.width),
          spp_(samples.spp()),
          seen_(static_cast<std::size_t>(width_) * frame.view.height * spp_) {
        MethodSettings method;
        method.culling = culling;
        const Visibility visibility(frame, samples, method, {0, frame.view.width, 0, frame.view.height});
        Hits hits;
        CoverCounts counts;
        for (const Tile& tile : visibility.tiles()) {
            visibility.cover(tile, hits, counts);
            for (int py = tile.y0; py < tile.y1; ++py)
                for (int px = tile.x0; px < tile.x1; ++px)
                    for (int index = 0; index < spp_; ++index) {
                        const std::size_t s = hits.entry(px, py, samples.slot_of(px, py, index));
                        seen_[offset(px, py, index)] = {hits.triangle[s], hits.depth[s]};
                    }
        }
    }
    const Seen& at(int px, int py, int index) const { return seen_[offset(px, py, index)]; }
    int covered(int px, int py) const {
        int n = 0;
        for (int index = 0; index < spp_; ++index) n += at(px, py, index).hit();
        return n;
    }
    bool operator==(const Visible&) const = default;

  private:
    std::size_t offset(int px, int py, int index) const {
        return (static_cast<std::size_t>(py) * width_ + px) * spp_ + index;
    }
    int width_, spp_;
    std::vector<Seen> seen_;
};

/// A frame with one part and no triangle yet: raster clip space in pixels, near plane at 0.1.
inline Frame empty_frame(int width, int height, bool moves, int segments = 1) {
    Frame frame;
    frame.view.width = width;
    frame.view.height = height;
    frame.view.depth_near = 0.1;
    Part part;
    part.moves = moves;
    part.segments = moves ? segments : 1;
    frame.parts.push_back(part);
    return frame;
}

/// Fills the frame's part with vertices, knot by knot, and triangles.
inline void set_mesh(Frame& frame, const std::vector<std::vector<glm::vec4>>& knots,
                     const std::vector<std::uint32_t>& corners) {
    frame.points.clear();
    for (const auto& knot : knots) frame.points.insert(frame.points.end(), knot.begin(), knot.end());
    frame.corners.assign(corners.begin(), corners.end());
    frame.part_of.assign(corners.size() / 3, 0);
    frame.parts[0].vertex_count = static_cast<std::uint32_t>(knots[0].size());
    frame.parts[0].triangle_count = static_cast<std::uint32_t>(corners.size() / 3);
}

}  // namespace pentaprism::support
