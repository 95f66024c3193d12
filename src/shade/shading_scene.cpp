#include "shade/shading_scene.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "base/parallel.h"

namespace pentaprism {
namespace {

BoundTexture bind(const Pyramid* pyramid, const TextureRef& ref) {
    return {pyramid, ref, uv_matrix(ref), ref.texcoord == 1 ? 1 : 0};
}

BoundMaterial bind(const Material& material, const Textures* textures) {
    BoundMaterial bound;
    bound.material = material;
    if (!textures) return bound;
    bound.base_color = bind(textures->color(material.base_color_texture), material.base_color_texture);
    bound.emissive = bind(textures->color(material.emissive_texture), material.emissive_texture);
    bound.metallic_roughness =
        bind(textures->data(material.metallic_roughness_texture), material.metallic_roughness_texture);
    bound.occlusion = bind(textures->data(material.occlusion_texture), material.occlusion_texture);
    bound.textured = bound.base_color.pyramid || bound.emissive.pyramid || bound.metallic_roughness.pyramid ||
                     bound.occlusion.pyramid;
    return bound;
}

void pose_part(const Frame& frame, const Part& part, const glm::dvec3& eye, ShadedPart& out) {
    const std::size_t n = out.primitive->positions.size();
    std::vector<glm::dvec3> world(n);
    out.positions.resize(n);
    out.normals.resize(n);
    pose_positions(*frame.scene, frame.middle, part.placement, world);
    pose_normals(*frame.scene, frame.middle, part.placement, out.normals);
    for (std::size_t i = 0; i < n; ++i) out.positions[i] = glm::vec3(world[i] - eye);
}

}  // namespace

ShadingScene::ShadingScene(const Frame& frame, const ShadingOptions& options) : frame_(frame) {
    const Scene& scene = *frame.scene;
    const glm::dmat4 camera_to_world = glm::inverse(world_to_camera(frame.view, frame.middle));
    const glm::dvec3 eye(camera_to_world[3]);
    backwards_ = glm::vec3(glm::normalize(glm::dvec3(camera_to_world[2])));
    lighting_ = pose_lights(frame, eye);
    shadows_ = std::make_unique<Shadows>(frame, lighting_, eye, options.shadows);

    materials_.reserve(scene.materials.size() + 1);
    for (const Material& material : scene.materials) materials_.push_back(bind(material, frame.textures.get()));
    materials_.push_back(bind(Material{}, nullptr));

    parts_.resize(frame.parts.size());
    parallel_for(parts_.size(), [&](std::size_t i) {
        const Part& part = frame.parts[i];
        parts_[i].primitive = &scene.meshes[part.placement.mesh].primitives[part.placement.primitive];
        parts_[i].material = part.material == kNone ? &materials_.back() : &materials_[part.material];
        pose_part(frame, part, eye, parts_[i]);
    });
}

float ShadingScene::shadow_texel(const glm::vec3& position) const {
    const View& view = frame_.view;
    const double depth = -glm::dot(glm::dvec3(position), glm::dvec3(backwards_));
    const double w = view.perspective ? std::max(depth, view.depth_near) : 1.0;
    const double blur = 2.0 * std::abs(view.lens.a + view.lens.b * depth) / w;
    return static_cast<float>(w / view.fx * std::max(1.0, 0.25 * blur));
}

glm::vec3 ShadingScene::to_eye(const glm::vec3& position) const {
    if (!frame_.view.perspective) return backwards_;
    const float length = glm::length(position);
    return length > 0.0f ? position * (-1.0f / length) : backwards_;
}

}  // namespace pentaprism
