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

Float4 widened(const glm::vec3& v) {
    return Float4{v.x, v.y, v.z, 0.0f};
}
Float4 widened(const glm::vec4& v) {
    return Float4{v.x, v.y, v.z, v.w};
}
glm::vec3 first_three(const Float4& v) {
    return {v[0], v[1], v[2]};
}

Float4 interpolate(const Float4 corners[3], const glm::vec3& b) {
    return splat(b.x) * corners[0] + splat(b.y) * corners[1] + splat(b.z) * corners[2];
}

}  // namespace

ShadedTriangle::ShadedTriangle(const ShadingScene& scene, std::uint32_t triangle, float blur_share)
    : scene_(scene),
      triangle_(triangle),
      blur_share_(blur_share),
      part_(scene.part_of(triangle)),
      piece_(scene.frame().pieces.empty() ? nullptr : scene.frame().pieces[triangle].corner),
      vertices_(scene.frame().vertices(triangle)) {
    if (part_.material->textured || scene.options().rate == ShadingRate::kDecoupled) project();
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
    read_attributes();
    if (part_.material->textured) set_up_textures();
}

void ShadedTriangle::read_attributes() {
    const auto& colors = part_.primitive->colors;
    for (int i = 0; i < 3; ++i) {
        const std::uint32_t vertex = vertices_[i];
        corners_.position[i] = widened(part_.positions[vertex]);
        corners_.normal[i] = widened(part_.normals[vertex]);
        if (!part_.tangents.empty()) corners_.tangent[i] = widened(part_.tangents[vertex]);
        if (!colors.empty()) corners_.color[i] = widened(colors[vertex]);
    }
}

void ShadedTriangle::set_up_textures() {
    for (int i = 0; i < 3; ++i) {
        const auto uv = [&](int set) {
            const std::vector<glm::vec2>& uvs = part_.primitive->texcoords[set];
            return uvs.empty() ? glm::vec2(0.0f) : uvs[vertices_[i]];
        };
        const glm::vec2 first = uv(0), second = uv(1);
        corners_.uv[i] = Float4{first.x, first.y, second.x, second.y};
    }
    Float4 own[3];  // at the corners of the triangle itself
    for (int i = 0; i < 3; ++i)
        own[i] = piece_ ? interpolate(corners_.uv, in_source(glm::vec3(i == 0, i == 1, i == 2))) : corners_.uv[i];
    for (int set = 0; set < 2; ++set) {
        const auto uv = [&](int i) { return glm::dvec2(own[i][2 * set], own[i][2 * set + 1]); };
        uv_edges_[set][0] = uv(1) - uv(0);
        uv_edges_[set][1] = uv(2) - uv(0);
    }
}

inline glm::vec3 ShadedTriangle::in_source(const glm::vec3& b) const {
    if (!piece_) return b;
    const glm::vec2 p = b.x * piece_[0] + b.y * piece_[1] + b.z * piece_[2];
    return {1.0f - p.x - p.y, p.x, p.y};
}

// Barycentrics are w * M^-1 * (gx, gy, 1), where M has the corners (x, y, w) as columns; so their change over the
// screen is w * (column - barycentrics * sum of the column). In double: x and y are the whole picture's, the triangle
// may be tiny.
void ShadedTriangle::project() {
    const Frame& frame = scene_.frame();
    const int segments = frame.parts[frame.part_of[triangle_]].segments;
    const int segment = segments / 2;  // the one that holds t = 1/2
    const double s = 0.5 * segments - segment;
    const MovingTriangle middle = moving_triangle(frame, triangle_, segment);
    const MovingTriangle first = segment == 0 ? middle : moving_triangle(frame, triangle_, 0);
    const MovingTriangle last = segments == 1 ? middle : moving_triangle(frame, triangle_, segments - 1);
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
    projection_.sum_x = projection_.by_x.x + projection_.by_x.y + projection_.by_x.z;
    projection_.sum_y = projection_.by_y.x + projection_.by_y.y + projection_.by_y.z;
}

bool ShadedTriangle::is_sharp() const {
    bool sharp = true;
    for (int i = 0; i < 3; ++i) sharp = sharp && projection_.motion[i] == glm::dvec3(0.0) && projection_.coc[i] == 0.0;
    return sharp;
}

// One evaluation is filtered over its cell (variance 1/12 each way) and over its share of the shutter (1/12) and of the
// lens disk (1/4 each way).
void ShadedTriangle::add_footprints(const glm::vec3& barycentrics, const ShadingCell& cell,
                                    TextureFootprint out[2]) const {
    const glm::dvec3 b(barycentrics);
    const glm::dvec3* corner = projection_.corner;
    const glm::dvec3 point = b.x * corner[0] + b.y * corner[1] + b.z * corner[2];
    if (!(point.z > 0.0) || scene_.options().texture_filter == TextureFilter::kOff) return;
    const glm::dvec3 dx = point.z * (projection_.by_x - b * projection_.sum_x);
    const glm::dvec3 dy = point.z * (projection_.by_y - b * projection_.sum_y);
    const glm::dvec3 motion = b.x * projection_.motion[0] + b.y * projection_.motion[1] + b.z * projection_.motion[2];
    const glm::vec2 velocity((glm::dvec2(motion) - motion.z / point.z * glm::dvec2(point)) / point.z);
    const float coc = static_cast<float>(glm::dot(b, projection_.coc) / point.z);
    const float ratio = static_cast<float>(scene_.frame().view.lens.ratio);
    const float share = blur_share_, lens = 0.25f * coc * coc * share;
    for (int set = 0; set < 2; ++set) {
        if (part_.primitive->texcoords[set].empty()) continue;
        const glm::dvec2* edges = uv_edges_[set];
        const glm::vec2 by_x(dx.y * edges[0] + dx.z * edges[1]), by_y(dy.y * edges[0] + dy.z * edges[1]);
        TextureFootprint& footprint = out[set];
        footprint.add(by_x * cell.along.x + by_y * cell.along.y, 1.0f / 12.0f);
        footprint.add(by_x * cell.across.x + by_y * cell.across.y, 1.0f / 12.0f);
        if (scene_.options().texture_filter == TextureFilter::kPixel) continue;
        footprint.add(by_x, lens);
        footprint.add(by_y, lens * ratio * ratio);
        footprint.add(by_x * velocity.x + by_y * velocity.y, share / 12.0f);
    }
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
    if (piece_ && sum > 0.0) {
        const glm::vec3 b((1.0 / sum) * over_w), source = in_source(b);
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
    const glm::vec3 b = in_source(barycentrics);
    SurfacePoint point;
    if (part_.material->textured) {
        const Float4 uv = interpolate(corners_.uv, b);
        point.uv[0] = {uv[0], uv[1]};
        point.uv[1] = {uv[2], uv[3]};
        add_footprints(barycentrics, cell, point.footprint);
    }
    if (!part_.primitive->colors.empty()) point.color = first_three(interpolate(corners_.color, b));
    point.position = first_three(interpolate(corners_.position, b));
    point.normal = first_three(interpolate(corners_.normal, b));
    if (!part_.tangents.empty()) {
        const Float4 tangent = interpolate(corners_.tangent, b);
        point.tangent = {tangent[0], tangent[1], tangent[2], tangent[3]};
    }
    point.has_tangent = !part_.tangents.empty();
    point.face = front ? face_normal_ : -face_normal_;
    point.front = front;
    point.bulge = bulge(b, front);
    return point;
}

}  // namespace pentaprism
