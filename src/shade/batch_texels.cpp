#include "shade/batch_texels.h"

namespace pentaprism {
namespace {

// One point after the other: drawn pixels, whose nearest texels are asked for.
void sample_each(const TextureLanes& work) {
    for (int lane = 0; lane < work.batch->count; ++lane) {
        const SurfacePoint point = work.batch->get(lane);
        const int set = work.texture->set;
        const glm::vec4 texel = work.texture->sample(point.uv[set], point.footprint[set]);
        for (int k = 0; k < work.channels; ++k) work.out[k][lane] = texel[work.first_channel + k];
    }
}

}  // namespace

BatchTexels::BatchTexels() : sample_(sample_texture_lanes()) {}

void BatchTexels::look_up(const PointBatch& batch) {
    const auto fetch = [&](const BoundTexture& texture, int first_channel, int channels, Lanes* out) {
        if (!texture.pyramid) return;
        const TextureLanes work{&texture, &batch, first_channel, channels, out};
        texture.ref.nearest ? sample_each(work) : sample_(work);
    };
    const BoundMaterial& bound = *batch.material;
    fetch(bound.base_color, 0, 3, base);
    if (bound.material.unlit) return;
    fetch(bound.metallic_roughness, 1, 2, metallic_roughness);
    fetch(bound.normal, 0, 3, normal);
    fetch(bound.emissive, 0, 3, emissive);
    fetch(bound.specular_color, 0, 3, specular_color);
    fetch(bound.occlusion, 0, 1, &occlusion);
    fetch(bound.specular, 3, 1, &specular);
}

}  // namespace pentaprism
