#pragma once
// What one light sees: depths at stratified points of texels and times, rendered cell by cell (shadow_raster.h) when a
// look-up first asks.
//
// Akenine-Moller, Munkberg, Hasselgren 2007 (shadow maps with a time for each sample). Here a texel has four samples,
// one for each quarter of the shutter. Resolution follows the receiver: levels of texels of 2^k metres, a virtual map
// each, of which the cells that are looked at exist (as in clipmaps, Tanner, Migdal, Jones 1998), so a texel is about
// as large as a pixel wherever it is. How points are compared with it: shadow_lookup.h.

#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "shade/find_casters.h"
#include "shade/shadow_cell_store.h"
#include "shade/shadow_raster.h"

namespace pentaprism {

class ShadowMap {
  public:
    static constexpr int kSamples = ShadowSamples::kSamples;

    /// `width`: texels that a level spans, both ways; a power of two. `world`, `samples` and `store`, of
    /// ShadowSamples::kPerCell floats, must outlive what is asked.
    ShadowMap(const WorldMotion& world, const ShadowSamples& samples, ShadowCellStore& store, const LightView& view,
              int width);
    ~ShadowMap();
    ShadowMap(const ShadowMap&) = delete;
    ShadowMap& operator=(const ShadowMap&) = delete;

    /// Finds the casters now, on all cores, and not when a cell is first asked for. Not from within a loop over cores.
    void prepare() const;

    const LightView& view() const { return view_; }
    int width() const { return width_; }
    /// Exponents of the finest and the coarsest level: texels of 2^k metres, or of the tangent.
    int least_exponent() const { return least_exponent_; }
    static constexpr int kCoarsest = 24;
    /// Level whose texels are as large as that, metres or tangents.
    int exponent_of(float texel) const;

    /// A cell with a lower limit of depth (casters.h) is rendered faster.
    int limit_of(float depth) const { return pentaprism::limit_of(depth, view_.perspective); }

    /// Depths beyond which a cell's samples are in shadow (DrawShadowCell); infinite where nothing is hit before the
    /// limit, and perhaps so beyond it. Thread-safe, and the same whoever asks first. They stay for the visit of the
    /// store during which they are asked for.
    const float* depths(int exponent, int limit, int cx, int cy) const;
    /// Whether these depths are those of a cell in which nothing is.
    static bool is_empty(const float* depths);
    const ShadowSamples& samples() const { return samples_; }
    ShadowCellStore& store() const { return store_; }

    std::int64_t cells_rendered() const { return cells_rendered_; }

  private:
    struct Cell {
        ShadowCellStore::Cell depths;
        std::atomic<bool> empty{false};  // known to hold nothing
    };
    struct Page;
    struct Level;

    void make(bool parallel) const;
    const Casters& casters() const;
    Level& level(int exponent, int limit) const;
    Cell& cell(Level& level, int cx, int cy) const;
    bool render(int exponent, int limit, int cx, int cy, float* bounds) const;

    const WorldMotion& world_;
    const ShadowSamples& samples_;
    ShadowCellStore& store_;
    FindCasters find_;
    DrawShadowCell draw_;
    LightView view_;
    int width_, least_exponent_;
    mutable std::once_flag made_;
    mutable Casters casters_;
    std::unique_ptr<std::atomic<Level*>[]> levels_;
    mutable std::atomic<std::int64_t> cells_rendered_{0};
};

}  // namespace pentaprism
