#include "render/layer_shading.h"

namespace pentaprism {

std::int64_t LayerShader::shade(const Visibility& visibility, const ShadingScene& scene, const SampleTable& samples,
                                const Tile& tile, const glm::vec3& background, Hits& hits, TileShade& out,
                                CoverCounts& counts) {
    visibility.cover_solid(tile, samples, hits, counts);
    solid_ = hits;
    seen_.assign(hits.triangle.size(), Seen{});
    half_.reset(samples.slots(), tile);
    count_ = 0;
    layers_.reset(hits.triangle.size());
    do {
        visibility.cover_layers(tile, samples, solid_, layers_, counts);
        blend_pass(scene, samples, tile);
    } while (layers_.next_pass());
    count_ += shader_.shade(scene, samples, tile, solid_, out);
    blend_solid(background, out);
    for (std::size_t sample = 0; sample < seen_.size(); ++sample) {
        if (half_.triangle[sample] == kNoTriangle) continue;
        hits.triangle[sample] = half_.triangle[sample];
        hits.depth[sample] = half_.depth[sample];
    }
    return count_;
}

// The layers of one pass: the nearest of all samples, then the next.
void LayerShader::blend_pass(const ShadingScene& scene, const SampleTable& samples, const Tile& tile) {
    for (int layer = 0;; ++layer) {
        layer_.reset(samples.slots(), tile);
        bool any = false;
        const auto fragment_of = [&](std::size_t sample) -> const Fragment* {
            const std::span<const Fragment> fragments = layers_.fragments(sample);
            const bool seen = static_cast<std::size_t>(layer) < fragments.size() && seen_[sample].passed > 0.0f;
            return seen ? &fragments[layer] : nullptr;
        };
        for (std::size_t sample = 0; sample < seen_.size(); ++sample)
            if (const Fragment* fragment = fragment_of(sample)) {
                layer_.triangle[sample] = fragment->triangle;
                layer_.depth[sample] = fragment->depth;
                any = true;
            }
        if (!any) return;
        count_ += shader_.shade(scene, samples, tile, layer_, shaded_);
        for (std::size_t sample = 0; sample < seen_.size(); ++sample)
            if (const Fragment* fragment = fragment_of(sample))
                blend(sample, glm::vec3(shaded_.colors[shaded_.point_of_sample[sample]]), *fragment);
    }
}

void LayerShader::blend(std::size_t sample, const glm::vec3& color, const Fragment& fragment) {
    Seen& seen = seen_[sample];
    seen.color += seen.passed * fragment.opacity * color;
    const float passed = seen.passed * (1.0f - fragment.opacity);
    if (seen.passed > 0.5f && passed <= 0.5f) {
        half_.triangle[sample] = fragment.triangle;
        half_.depth[sample] = fragment.depth;
    }
    seen.passed = passed;
}

// What lies behind all layers. A sample that has layers gets a colour of its own.
void LayerShader::blend_solid(const glm::vec3& background, TileShade& out) {
    for (std::size_t sample = 0; sample < seen_.size(); ++sample) {
        const Seen& seen = seen_[sample];
        if (seen.passed == 1.0f) continue;
        std::uint32_t& point = out.point_of_sample[sample];
        const glm::vec4 behind = point == kBackground ? glm::vec4(background, 0.0f) : out.colors[point];
        point = static_cast<std::uint32_t>(out.colors.size());
        out.colors.emplace_back(seen.color + seen.passed * glm::vec3(behind), 1.0f - seen.passed * (1.0f - behind.w));
    }
}

}  // namespace pentaprism
