#pragma once
// What one light sees: depths at stratified points of texels and times, rendered by the coverage stage with the lens
// closed, cell by cell when a look-up first asks.
//
// Akenine-Moller, Munkberg, Hasselgren 2007 (shadow maps with a time for each sample). Here a texel has four samples,
// one for each quarter of the shutter; the receiver is put where it is at the map sample's own time, and its depth is
// taken on its own plane at the map sample's own place, so that a surface does not shadow itself and no bias has to
// hide that. Resolution follows the receiver: levels of texels of 2^k metres, a virtual map each, of which the cells
// that are looked at exist (as in clipmaps, Tanner, Migdal, Jones 1998), so a texel is about as large as a pixel
// wherever it is.

#include <atomic>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <memory>
#include <vector>

#include "frame/frame.h"
#include "sample/sample_table.h"
#include "shade/world_motion.h"

namespace pentaprism {

/// From where and which way a light looks, relative to the world motion's origin.
struct LightView {
    bool perspective = false;
    glm::dvec3 position{0.0};  ///< of a perspective one; an orthographic one looks from the origin, both ways
    glm::dmat3 axes{1.0};      ///< columns: right, up, forward; orthonormal
};

/// Material points of a triangle whose light is asked for, all in one quarter of the shutter.
struct ShadowReceiver {
    static constexpr int kPoints = 4;
    std::uint32_t triangle = 0;
    int quarter = 0;
    int count = 0;              ///< of the points: 1 to kPoints
    glm::vec3 points[kPoints];  ///< barycentrics
    float texel = 0.0f;         ///< the size that a texel of the map should have there, metres
    glm::vec3 offset{0.0f};     ///< added to where the triangle is, metres
};

class ShadowMap {
  public:
    static constexpr int kSamples = 4;  ///< of a texel: one for each quarter of the shutter

    /// `width`: texels that a level spans, both ways; a power of two. `world`, `frame` and `table` (kSamples, pinhole,
    /// grouped by motion) must outlive this.
    ShadowMap(const WorldMotion& world, const Frame& frame, const SampleTable& table, const LightView& view, int width);
    ~ShadowMap();
    ShadowMap(const ShadowMap&) = delete;
    ShadowMap& operator=(const ShadowMap&) = delete;

    /// Share of the light that reaches the points in their quarter of the shutter, by four map samples (two for a
    /// single point) in the texels around them; `seed` moves them. Thread-safe; a pure function of its arguments.
    float lit(const ShadowReceiver& receiver, std::uint32_t seed) const;

    std::int64_t cells_rendered() const { return cells_rendered_; }

  private:
    /// One motion segment of one triangle in the light's view: level-0 units (metres or tangents), y up.
    struct Box {
        float x0, x1, y0, y1, nearest;
        std::uint32_t triangle;
        std::uint16_t segment;
    };
    using List = std::vector<std::uint32_t>;  // into boxes_, front to back
    struct Cell {
        std::atomic<const List*> list{nullptr};
        std::atomic<const float*> depths{nullptr};  // as Hits::depth
    };
    struct Page;
    struct Level;
    struct Corners;

    void bound_triangles();
    Level& level(int exponent) const;
    Cell& cell(Level& level, int cx, int cy) const;
    const List& list(int exponent, int cx, int cy) const;
    const float* depths(int exponent, int cx, int cy) const;
    std::unique_ptr<float[]> render(int exponent, int cx, int cy, const List& list) const;
    Corners corners(std::uint32_t triangle, int segment) const;

    const SampleTable& table_;
    glm::mat3 axes_;
    int width_, least_exponent_, root_exponent_;
    Frame frame_;  // level 0
    std::vector<Box> boxes_;
    std::unique_ptr<std::atomic<Level*>[]> levels_;
    mutable std::atomic<std::int64_t> cells_rendered_{0};
};

}  // namespace pentaprism
