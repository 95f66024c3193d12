#include "shade/shaded_triangle.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "shade/unit_vector.h"

namespace pentaprism {
namespace {

// Cosine between a facet and the normals at its corners: up to here it stands for a smooth surface, from here not.
constexpr float kSmooth = 0.5f, kSpread = 0.25f;

template <typename T>
T interpolate(const std::vector<T>& values, const std::array<std::uint32_t, 3>& vertices, const glm::vec3& b) {
    return b.x * values[vertices[0]] + b.y * values[vertices[1]] + b.z * values[vertices[2]];
}

}  // namespace

ShadedTriangle::ShadedTriangle(const ShadingScene& scene, std::uint32_t triangle, int spp)
    : scene_(scene),
      triangle_(triangle),
      blur_share_(scene.blur_share(spp)),
      part_(scene.part_of(triangle)),
      vertices_(scene.frame().vertices(triangle)) {
    if (part_.material->textured || scene.options().rate == ShadingRate::kDecoupled) project(triangle);
    const glm::vec3 &a = part_.positions[vertices_[0]], &b = part_.positions[vertices_[1]],
                    &c = part_.positions[vertices_[2]];
    face_normal_ = normalized_or(glm::cross(b - a, c - a), glm::vec3(0.0f));
    float least = 1.0f;
    for (int i = 0; i < 3; ++i) {
        const std::uint32_t from = vertices_[i], to = vertices_[(i + 1) % 3];
        turns_[i] = glm::dot(part_.normals[to] - part_.normals[from], part_.positions[to] - part_.positions[from]);
        least = std::min(least, glm::dot(part_.normals[from], face_normal_));
    }
    smoothness_ = std::clamp((least - kSpread) / (kSmooth - kSpread), 0.0f, 1.0f);
}

// Barycentrics are w * M^-1 * (gx, gy, 1), where M has the corners (x, y, w) as columns; so their change over the
// screen is w * (column - barycentrics * sum of the column). In double: x and y are the whole picture's, the triangle
// may be tiny.
void ShadedTriangle::project(std::uint32_t triangle) {
    const Frame& frame = scene_.frame();
    const int segments = frame.parts[frame.part_of[triangle]].segments;
    const int segment = segments / 2;  // the one that holds t = 1/2
    const double s = 0.5 * segments - segment;
    const MovingTriangle middle = moving_triangle(frame, triangle, segment);
    const MovingTriangle first = segment == 0 ? middle : moving_triangle(frame, triangle, 0);
    const MovingTriangle last = segments == 1 ? middle : moving_triangle(frame, triangle, segments - 1);
    const auto between = [s](const float ends[2]) { return ends[0] + (static_cast<double>(ends[1]) - ends[0]) * s; };
    glm::dvec3* corner = projection_.corner;
    for (int i = 0; i < 3; ++i) {
        corner[i] = {between(middle.x[i]), between(middle.y[i]), between(middle.w[i])};
        projection_.coc[i] = between(middle.c[i]);
        projection_.motion[i] = glm::dvec3(last.x[i][1], last.y[i][1], last.w[i][1]) -
                                glm::dvec3(first.x[i][0], first.y[i][0], first.w[i][0]);
        cells_.x[i] = static_cast<float>(corner[i].x);
        cells_.y[i] = static_cast<float>(corner[i].y);
        cells_.w[i] = static_cast<float>(corner[i].z);
        cells_.coc[i] = static_cast<float>(projection_.coc[i]);
        cells_.motion_x[i] = static_cast<float>(projection_.motion[i].x);
        cells_.motion_y[i] = static_cast<float>(projection_.motion[i].y);
        cells_.motion_w[i] = static_cast<float>(projection_.motion[i].z);
    }
    cells_.w_near = static_cast<float>(frame.view.w_near());
    const glm::dvec3 rows[3] = {glm::cross(corner[1], corner[2]), glm::cross(corner[2], corner[0]),
                                glm::cross(corner[0], corner[1])};
    const double determinant = glm::dot(corner[0], rows[0]);
    const double scale = determinant != 0.0 ? 1.0 / determinant : 0.0;  // edge-on: no derivatives
    projection_.by_x = scale * glm::dvec3(rows[0].x, rows[1].x, rows[2].x);
    projection_.by_y = scale * glm::dvec3(rows[0].y, rows[1].y, rows[2].y);
    projection_.by_1 = scale * glm::dvec3(rows[0].z, rows[1].z, rows[2].z);
}

bool ShadedTriangle::is_sharp() const {
    bool sharp = true;
    for (int i = 0; i < 3; ++i) sharp = sharp && projection_.motion[i] == glm::dvec3(0.0) && projection_.coc[i] == 0.0;
    return sharp;
}

// One evaluation is filtered over its cell (variance 1/12 each way) and over its share of the shutter (1/12) and of the
// lens disk (1/4 each way).
TextureFootprint ShadedTriangle::footprint(const glm::vec3& barycentrics, int set, const ShadingCell& cell) const {
    const std::vector<glm::vec2>& uvs = part_.primitive->texcoords[set];
    if (uvs.empty()) return {};
    const glm::dvec3 b(barycentrics);
    const glm::dvec3* corner = projection_.corner;
    const glm::dvec3 point = b.x * corner[0] + b.y * corner[1] + b.z * corner[2];
    if (!(point.z > 0.0) || scene_.options().texture_filter == TextureFilter::kOff) return {};
    const glm::dvec3 dx =
        point.z * (projection_.by_x - b * (projection_.by_x.x + projection_.by_x.y + projection_.by_x.z));
    const glm::dvec3 dy =
        point.z * (projection_.by_y - b * (projection_.by_y.x + projection_.by_y.y + projection_.by_y.z));
    const Frame& frame = scene_.frame();
    const auto uv = [&](int k) {
        if (frame.pieces.empty()) return glm::dvec2(uvs[vertices_[k]]);
        return glm::dvec2(interpolate(uvs, vertices_, frame.in_source(triangle_, glm::vec3(k == 0, k == 1, k == 2))));
    };
    const glm::dvec2 edge1 = uv(1) - uv(0), edge2 = uv(2) - uv(0);
    const glm::vec2 by_x(dx.y * edge1 + dx.z * edge2), by_y(dy.y * edge1 + dy.z * edge2);

    const glm::dvec3 motion = b.x * projection_.motion[0] + b.y * projection_.motion[1] + b.z * projection_.motion[2];
    const glm::vec2 velocity((glm::dvec2(motion) - motion.z / point.z * glm::dvec2(point)) / point.z);
    const float coc = static_cast<float>(glm::dot(b, projection_.coc) / point.z);
    const float ratio = static_cast<float>(frame.view.lens.ratio);

    TextureFootprint footprint;
    footprint.add(by_x * cell.along.x + by_y * cell.along.y, 1.0f / 12.0f);
    footprint.add(by_x * cell.across.x + by_y * cell.across.y, 1.0f / 12.0f);
    if (scene_.options().texture_filter == TextureFilter::kPixel) return footprint;
    const float share = blur_share_;
    const float lens = 0.25f * coc * coc * share;
    footprint.add(by_x, lens);
    footprint.add(by_y, lens * ratio * ratio);
    footprint.add(by_x * velocity.x + by_y * velocity.y, share / 12.0f);
    return footprint;
}

namespace {

// From barycentrics over w, up to a factor: moved into the triangle, with sum 1.
glm::vec3 inside(const glm::dvec3& over_w) {
    const double sum = over_w.x + over_w.y + over_w.z;
    const glm::dvec3 kept = glm::max(sum < 0.0 ? -over_w : over_w, glm::dvec3(0.0));
    const double total = kept.x + kept.y + kept.z;
    return total > 0.0 && std::isfinite(total) ? glm::vec3((1.0 / total) * kept) : glm::vec3(1.0f / 3.0f);
}

}  // namespace

// A piece of a cut triangle (frame/cut_triangles.h) may be a long, thin strip, in which the way back from the middle of
// a cell can be long; a place beside it is as good while it is on the triangle that was cut.
glm::vec3 ShadedTriangle::on_surface(const glm::dvec3& over_w) const {
    const double sum = over_w.x + over_w.y + over_w.z;
    if (!scene_.frame().pieces.empty() && sum > 0.0) {
        const glm::vec3 b((1.0 / sum) * over_w), source = scene_.frame().in_source(triangle_, b);
        if (source.x >= 0.0f && source.y >= 0.0f && source.z >= 0.0f) return b;
    }
    return inside(over_w);
}

glm::vec3 ShadedTriangle::barycentrics_at(const glm::dvec2& place) const {
    return on_surface(projection_.by_x * place.x + projection_.by_y * place.y + projection_.by_1);
}

void ShadedTriangle::barycentrics_of_quarters(const ShadingCell& cell, glm::vec3 out[4]) const {
    const auto change = [&](const glm::dvec2& way) { return projection_.by_x * way.x + projection_.by_y * way.y; };
    const glm::dvec3 middle = change(cell.centre) + projection_.by_1;
    const glm::dvec3 along = change(0.25 * glm::dvec2(cell.along)), across = change(0.25 * glm::dvec2(cell.across));
    out[0] = on_surface(middle - along - across);
    out[1] = on_surface(middle + along - across);
    out[2] = on_surface(middle - along + across);
    out[3] = on_surface(middle + along + across);
}

// How far the smooth surface bulges out over the facet, along the smooth normal: a parabola over each edge that follows
// the turn of the normals along it (as high as Hanika 2021, Hacking the Shadow Terminator, lifts the point, but nothing
// where normals merely spread, as on leaves that are to look like a ball: those lean far from the facet).
float ShadedTriangle::bulge(const glm::vec3& b, bool front) const {
    float height = 0.0f;
    for (int i = 0; i < 3; ++i) height += b[i] * b[(i + 1) % 3] * std::max(0.0f, front ? turns_[i] : -turns_[i]);
    return smoothness_ * height;
}

SurfacePoint ShadedTriangle::surface(const glm::vec3& barycentrics, bool front, const ShadingCell& cell) const {
    const Primitive& primitive = *part_.primitive;
    const glm::vec3 b = scene_.frame().in_source(triangle_, barycentrics);  // of vertices_
    SurfacePoint point;
    if (part_.material->textured)
        for (int set = 0; set < 2; ++set) {
            if (primitive.texcoords[set].empty()) continue;
            point.uv[set] = interpolate(primitive.texcoords[set], vertices_, b);
            point.footprint[set] = footprint(barycentrics, set, cell);
        }
    if (!primitive.colors.empty()) point.color = glm::vec3(interpolate(primitive.colors, vertices_, b));
    point.position = interpolate(part_.positions, vertices_, b);
    point.normal = interpolate(part_.normals, vertices_, b);
    if (!part_.tangents.empty()) point.tangent = interpolate(part_.tangents, vertices_, b);
    point.has_tangent = !part_.tangents.empty();
    point.face = front ? face_normal_ : -face_normal_;
    point.front = front;
    point.bulge = bulge(b, front);
    return point;
}

}  // namespace pentaprism
