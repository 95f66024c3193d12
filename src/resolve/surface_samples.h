#pragma once
// What a sample that hit something sees there: the exact point of the exact triangle at the sample's own time.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "bound/local_triangle.h"
#include "cover/hits.h"
#include "shade/projection.h"
#include "shade/shading_scene.h"

namespace pentaprism {

struct SurfaceSample {
    std::uint32_t part_index = 0;  ///< into Frame::parts, of every frame of the scene
    const Part* part = nullptr;
    const ShadedPart* shaded = nullptr;
    std::array<std::uint32_t, 3> vertices{};  ///< of the Primitive: Frame::vertices()
    glm::vec3 barycentrics{0.0f};             ///< among these, sum 1
    bool front = true;
    float depth = 0, t = 0;
    float coc = 0;  ///< signed radius in pixels
};

/// Looks points up for the samples of one tile. Keeps the triangles it was asked for lately: neighbours ask for the
/// same.
class SurfaceSamples {
  public:
    void start(const ShadingScene& scene, const Tile& tile);
    SurfaceSample at(std::uint32_t triangle, float depth, const LocalSample& sample);

  private:
    struct Entry {
        std::uint32_t triangle = kNoTriangle;
        int segment = 0;
        LocalTriangle local;
        CornerLanes lanes;
    };
    const Entry& entry(std::uint32_t triangle, int segment);

    const ShadingScene* scene_ = nullptr;
    CellCentre centre_{};
    std::vector<Entry> entries_;
};

}  // namespace pentaprism
