#pragma once
// What the textures of a material say of sixteen points.

#include "shade/point_batch.h"

namespace pentaprism {

/// Only of textures that the material has; [channel][lane].
struct BatchTexels {
    using Lanes = PointBatch::Lanes;
    alignas(64) Lanes base[3], metallic_roughness[3], normal[3], emissive[3], specular_color[3];
    alignas(64) Lanes occlusion, specular;

    /// Of the batch's first `count` lanes. The textures of further layers are left out.
    void look_up(const PointBatch& batch);
};

}  // namespace pentaprism
