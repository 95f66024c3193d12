#pragma once
// What the textures of a material say of sixteen points.

#include "shade/texture_lanes.h"

namespace pentaprism {

/// Only of textures that the material has; [channel][lane].
struct BatchTexels {
    using Lanes = PointBatch::Lanes;
    alignas(64) Lanes base[3], normal[3], emissive[3], specular_color[3];
    alignas(64) Lanes metallic_roughness[2];  ///< roughness, metallic
    alignas(64) Lanes occlusion, specular;

    BatchTexels();

    /// Of the batch's first `count` lanes. The textures of further layers are left out.
    void look_up(const PointBatch& batch);

  private:
    SampleTextureLanes sample_;
};

}  // namespace pentaprism
