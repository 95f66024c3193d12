#include "shade/shading_scene.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "base/parallel.h"

namespace pentaprism {
namespace {

constexpr int kCameraKnots = 8;

BoundTexture bind(const Pyramid* pyramid, const TextureRef& ref) {
    return {pyramid, ref, uv_matrix(ref), ref.texcoord == 1 ? 1 : 0};
}

BoundMaterial bind(const Material& material, const Textures* textures) {
    BoundMaterial bound;
    bound.material = material;
    bound.layered =
        material.clearcoat > 0.0f || material.sheen_color != glm::vec3(0.0f) || material.transmission > 0.0f;
    if (!textures) return bound;
    const auto color = [&](BoundTexture& out, const TextureRef& ref) { out = bind(textures->color(ref), ref); };
    const auto data = [&](BoundTexture& out, const TextureRef& ref) { out = bind(textures->data(ref), ref); };
    color(bound.base_color, material.base_color_texture);
    color(bound.emissive, material.emissive_texture);
    color(bound.specular_color, material.specular_color_texture);
    color(bound.sheen_color, material.sheen_color_texture);
    data(bound.metallic_roughness, material.metallic_roughness_texture);
    data(bound.normal, material.normal_texture);
    data(bound.occlusion, material.occlusion_texture);
    data(bound.specular, material.specular_texture);
    data(bound.coat, material.clearcoat_texture);
    data(bound.coat_roughness, material.clearcoat_roughness_texture);
    data(bound.coat_normal, material.clearcoat_normal_texture);
    data(bound.sheen_roughness, material.sheen_roughness_texture);
    data(bound.transmission, material.transmission_texture);
    for (const BoundTexture* texture :
         {&bound.base_color, &bound.emissive, &bound.specular_color, &bound.sheen_color, &bound.metallic_roughness,
          &bound.normal, &bound.occlusion, &bound.specular, &bound.coat, &bound.coat_roughness, &bound.coat_normal,
          &bound.sheen_roughness, &bound.transmission})
        bound.textured = bound.textured || texture->pyramid;
    return bound;
}

UninitializedVector<glm::vec3> posed_positions(const Frame& frame, const Placement& placement, std::size_t count,
                                               const glm::dvec3& eye) {
    UninitializedVector<glm::dvec3> world(count);
    pose_positions(*frame.scene, frame.middle, placement, world);
    UninitializedVector<glm::vec3> positions(count);
    for (std::size_t i = 0; i < count; ++i) positions[i] = glm::vec3(world[i] - eye);
    return positions;
}

void pose_directions(const Frame& frame, const Part& part, ShadedPart& out) {
    out.normals.resize(out.primitive->positions.size());
    pose_normals(*frame.scene, frame.middle, part.placement, out.normals);
    if (!frame.textures) return;
    const auto tangents = frame.textures->tangents(part.placement.mesh, part.placement.primitive);
    out.tangents.resize(tangents.size());
    if (!tangents.empty())
        pose_tangents(*frame.scene, frame.middle, part.placement, tangents, part.mirrored, out.tangents);
}

}  // namespace

ShadingScene::ShadingScene(const Frame& frame, const ShadingOptions& options) : frame_(frame), options_(options) {
    const Scene& scene = *frame.scene;
    const glm::dmat4 camera_to_world = glm::inverse(world_to_camera(frame.view, frame.middle));
    const glm::dvec3 eye(camera_to_world[3]);
    backwards_ = glm::vec3(glm::normalize(glm::dvec3(camera_to_world[2])));
    lighting_ = pose_lights(frame, eye, options.environment.get());
    if (options.environment) {
        const bool turns = frame.view.camera_node != kNone && frame.view.shutter.close > frame.view.shutter.open;
        for (int k = 0; turns && k <= kCameraKnots; ++k) {
            const double time = frame.view.shutter.at(static_cast<double>(k) / kCameraKnots);
            const Pose pose = evaluate(scene, frame.animations, time);
            cameras_.push_back(
                {glm::dmat3(glm::inverse(world_to_camera(frame.view, pose))), view_at(scene, frame.view, pose)});
        }
        if (!turns) cameras_.push_back({glm::dmat3(camera_to_world), frame.view});
    }
    shadows_ = std::make_unique<Shadows>(frame, lighting_, eye, options.shadows);

    materials_.reserve(scene.materials.size() + 1);
    for (const Material& material : scene.materials) materials_.push_back(bind(material, frame.textures.get()));
    materials_.push_back(bind(Material{}, nullptr));

    parts_.resize(frame.parts.size());
    positions_.resize(parts_.size());
    const WorldMotion& world = shadows_->world();
    parallel_for(parts_.size(), [&](std::size_t i) {
        const Part& part = frame.parts[i];
        parts_[i].primitive = &scene.meshes[part.placement.mesh].primitives[part.placement.primitive];
        parts_[i].material = part.material == kNone ? &materials_.back() : &materials_[part.material];
        const std::size_t count = parts_[i].primitive->positions.size();
        if (shadows_->any() && world.at_mid_shutter[i])
            parts_[i].positions = std::span(world.points).subspan(world.parts[i].first_point, count);
        else
            parts_[i].positions = positions_[i] = posed_positions(frame, part.placement, count, eye);
        pose_directions(frame, part, parts_[i]);
    });
}

float ShadingScene::blur_share(int spp) const {
    return options_.rate == ShadingRate::kPixel ? 1.0f : std::pow(static_cast<float>(spp), -0.8f);
}

glm::vec3 ShadingScene::background(float gx, float gy, float u, float v, float t) const {
    const auto seen_by = [&](const CameraKnot& camera) {
        if (!camera.view.perspective) return camera.to_world * glm::vec3(0.0f, 0.0f, -1.0f);
        // Far beyond any range of focus, where lines of sight are straight.
        const glm::dvec2 slope =
            line_of_sight(camera.view, gx, gy, u, v).direction / glm::dvec2(camera.view.fx, camera.view.fy);
        return camera.to_world * glm::vec3(slope, -1.0f);
    };
    const float at = t * static_cast<float>(cameras_.size() - 1);
    const std::size_t knot = std::min(static_cast<std::size_t>(at), cameras_.size() - 1);
    glm::vec3 direction = seen_by(cameras_[knot]);
    if (knot + 1 < cameras_.size())
        direction += (at - static_cast<float>(knot)) * (seen_by(cameras_[knot + 1]) - direction);
    return options_.environment->radiance(glm::normalize(direction));
}

float ShadingScene::shadow_texel(const glm::vec3& position) const {
    const View& view = frame_.view;
    const double depth = -glm::dot(glm::dvec3(position), glm::dvec3(backwards_));
    const double w = view.perspective ? std::max(depth, view.depth_near) : 1.0;
    const double blur = 2.0 * std::abs(view.coc(0.0, 0.0, depth)) / w;
    return static_cast<float>(w / view.fx * std::max(1.0, 0.25 * blur));
}

glm::vec3 ShadingScene::to_eye(const glm::vec3& position) const {
    if (!frame_.view.perspective) return backwards_;
    const float length = glm::length(position);
    return length > 0.0f ? position * (-1.0f / length) : backwards_;
}

}  // namespace pentaprism
