#include "shade/batch_texels.h"

namespace pentaprism {

void BatchTexels::look_up(const PointBatch& batch) {
    const auto fetch = [&](const BoundTexture& texture, Lanes* out, int first_channel, int channels) {
        if (!texture.pyramid) return;
        for (int lane = 0; lane < batch.count; ++lane) {
            const SurfacePoint point = batch.get(lane);
            const glm::vec4 texel = texture.sample(point.uv[texture.set], point.footprint[texture.set]);
            for (int k = 0; k < channels; ++k) out[k][lane] = texel[first_channel + k];
        }
    };
    const BoundMaterial& bound = *batch.material;
    fetch(bound.base_color, base, 0, 3);
    if (bound.material.unlit) return;
    fetch(bound.metallic_roughness, metallic_roughness, 0, 3);
    fetch(bound.normal, normal, 0, 3);
    fetch(bound.emissive, emissive, 0, 3);
    fetch(bound.specular_color, specular_color, 0, 3);
    fetch(bound.occlusion, &occlusion, 0, 1);
    fetch(bound.specular, &specular, 3, 1);
}

}  // namespace pentaprism
