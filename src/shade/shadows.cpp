#include "shade/shadows.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

namespace pentaprism {
namespace {

constexpr std::size_t kMostMaps = 64;   // memory; what comes later casts no shadow
constexpr float kWidestCone = 0.7853f;  // half angle that fits into one face of a cube

// Axes that hold still in the world when the camera moves, so that a still shadow's edge does too.
glm::dmat3 axes_along(const glm::dvec3& forward) {
    const glm::dvec3 other = std::abs(forward.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, other));
    return {right, glm::cross(right, forward), forward};
}

// Face of the cube that looks along one of the axes.
glm::dmat3 face_axes(const glm::dmat3& axes, int face) {
    const glm::dvec3 forward = axes[face / 2] * (face % 2 == 0 ? 1.0 : -1.0);
    return {axes[(face / 2 + 1) % 3], axes[(face / 2 + 2) % 3], forward};
}

// The level that suits a pixel spans at most the distance to it in pixels, both ways, which is the focal length times
// the slant of the ray; twice that, because texels may be half as large as pixels.
int level_width(const View& view) {
    const double tangent = view.perspective ? std::hypot(0.5 * view.width / view.fx, 0.5 * view.height / view.fy) : 1.0;
    const double focal = view.perspective ? std::max(view.fx, view.fy) : 0.5 * (view.width + view.height);
    const double reach = 4.0 * focal * std::sqrt(1.0 + tangent * tangent) + 64.0;
    return static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::clamp(reach, 2048.0, 32768.0))));
}

// 96 MB for 1280 pixels: what some rows of tiles ask of several lights (docs/develop/performance.md, Memory).
std::size_t cells_kept(const View& view) {
    return 6144 * static_cast<std::size_t>(std::max(view.width, 1280)) / 1280;
}

bool is_around(const PosedLight& light) {
    return light.kind == LightKind::kPoint || (light.kind == LightKind::kSpot && light.outer_cone > kWidestCone);
}

}  // namespace

Shadows::Shadows(const Frame& frame, const Lighting& lighting, const glm::dvec3& eye, ShadowMode mode)
    : store_(std::make_unique<ShadowCellStore>(ShadowSamples::kPerCell, cells_kept(frame.view))) {
    maps_.resize(lighting.lights.size());
    if (mode == ShadowMode::kOff || lighting.lights.empty()) return;
    world_ = world_motion(frame, eye, mode == ShadowMode::kStill);
    samples_ = std::make_unique<ShadowSamples>(0x5eed);
    const int width = level_width(frame.view);
    lookup_ = shadow_lookup();
    for (std::size_t i = 0; i < maps_.size(); ++i) {
        const PosedLight& light = lighting.lights[i];
        LightMaps& maps = maps_[i];
        const std::size_t faces = is_around(light) ? 6 : 1;
        if (!light.casts_shadow || light.intensity == glm::vec3(0.0f) || map_count_ + faces > kMostMaps) continue;
        any_ = true;
        const bool sun = light.kind == LightKind::kDirectional;
        maps.axes = faces == 1 ? axes_along(glm::dvec3(light.direction)) : glm::dmat3(1.0);
        maps.first = map_count_;
        map_count_ += faces;
        maps.position = sun ? glm::vec3(0.0f) : light.position;
        for (std::size_t face = 0; face < faces; ++face) {
            LightView view;
            view.perspective = !sun;
            view.position = maps.position;
            view.axes = glm::mat3(faces == 1 ? maps.axes : face_axes(maps.axes, static_cast<int>(face)));
            maps.faces.push_back(std::make_unique<ShadowMap>(world_, *samples_, *store_, view, width));
            if (sun) maps.faces.back()->prepare();  // every picture asks for it
        }
    }
}

std::int64_t Shadows::cells_rendered() const {
    std::int64_t cells = 0;
    for (const LightMaps& maps : maps_)
        for (const auto& face : maps.faces) cells += face->cells_rendered();
    return cells;
}

void ShadowsOnTriangle::start(const Shadows& shadows, std::uint32_t triangle) {
    shadows_ = &shadows;
    triangle_ = triangle;
    ++starts_;
    if (receivers_.size() < shadows.map_count_) receivers_.resize(shadows.map_count_);
}

std::uint32_t ShadowsOnTriangle::lit(std::size_t light, const ShadowPoint& point, std::uint32_t seed) {
    const Shadows::LightMaps& maps = shadows_->maps_[light];
    std::size_t face = 0;
    if (maps.faces.size() > 1) {
        const glm::vec3 from = point.position - maps.position, size = glm::abs(from);
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        face = 2 * axis + (from[axis] < 0.0f ? 1 : 0);
    }
    Receiver& receiver = receivers_[maps.first + face];
    if (receiver.started != starts_) {
        receiver.started = starts_;
        receiver.receiver.start(shadows_->world_, triangle_, *maps.faces[face]);
    }
    return shadows_->lookup_(receiver.receiver, point, seed);
}

}  // namespace pentaprism
