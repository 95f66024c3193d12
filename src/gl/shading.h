#pragma once
// `--shading pixel` on the device: from the hits of a region to colours, in four passes of compute shaders: gather the
// points that pixels see, shade each, look up its shadows, put it together. All of it needs a Device::Current.

#include <glm/vec4.hpp>

#include "gl/pipeline.h"
#include "gl/shading_upload.h"
#include "gl/shadow_cells.h"

namespace pentaprism::gl {

/// What a region's samples show.
struct RegionShade {
    std::vector<std::uint32_t> color_of_sample;  ///< as RegionHits::triangle; kBackground where nothing is hit
    std::vector<glm::vec4> colors;               ///< four for each point: of the quarters of the shutter
};

class Shading {
  public:
    /// Scene and table must outlive it. Throws Error(kBackend) if something does not fit the device.
    Shading(Device& device, const ShadingScene& scene, const SampleTable& table);

    RegionShade shade(const Region& region, const RegionHits& hits);

  private:
    /// Blocks of a region, counted cell by cell.
    struct Batch {
        std::size_t first_block, blocks;
    };
    void send(const Region& region, const RegionHits& hits, const Batch& batch);
    std::uint32_t gather(const Region& region, const Batch& batch);
    void shade_points(std::uint32_t points);
    void look_up_shadows(std::uint32_t first, std::uint32_t count);
    void receive(const Region& region, const Batch& batch, std::uint32_t points, RegionShade& out);

    const ShadingScene& scene_;
    const SampleTable& table_;
    const Program &gather_, &points_, &shadows_, &finish_;
    ShadingUpload upload_;
    ShadowCells cells_;
    std::size_t most_blocks_, most_points_;  // at once; points of which shares are kept
    Buffer samples_, seen_, color_of_sample_, counter_, shade_points_, lanes_, shares_, colors_;
    std::vector<glm::uvec4> packed_;
    std::vector<std::uint32_t> numbers_;
};

}  // namespace pentaprism::gl
