#pragma once
// The shadow maps of a frame's lights: one for the sun, one for a narrow spot, six for a light that shines all around.

#include <memory>
#include <vector>

#include "shade/lights.h"
#include "shade/shadow_map.h"

namespace pentaprism {

class Shadows {
  public:
    /// Positions of lights are relative to `eye`. `frame` must outlive this.
    Shadows(const Frame& frame, const Lighting& lighting, const glm::dvec3& eye, ShadowMode mode);

    bool any() const { return any_; }
    bool casts(std::size_t light) const { return !maps_[light].faces.empty(); }

    /// Share of the light that reaches the point; 1 for a light without shadows. `position`: of the point, relative to
    /// the eye.
    float lit(std::size_t light, const ShadowReceiver& receiver, const glm::vec3& position, std::uint32_t seed) const;

    /// Cells of all maps rendered so far; a cell that two threads needed at once may count twice.
    std::int64_t cells_rendered() const;

  private:
    struct LightMaps {
        glm::dmat3 axes{1.0};
        glm::vec3 position{0.0f};
        std::vector<std::unique_ptr<ShadowMap>> faces;  // none: no shadows; 1, or 6: +x -x +y -y +z -z of the axes
    };
    WorldMotion world_;
    std::unique_ptr<SampleTable> table_;
    std::vector<LightMaps> maps_;
    bool any_ = false;
};

}  // namespace pentaprism
