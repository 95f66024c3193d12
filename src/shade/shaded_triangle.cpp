#include "shade/shaded_triangle.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "shade/brdf.h"

namespace pentaprism {
namespace {

// Cosine of face and light below which points are lifted to the smooth surface, little by little.
constexpr float kGrazing = 0.1f;

template <typename T>
T interpolate(const std::vector<T>& values, const std::array<std::uint32_t, 3>& vertices, const glm::vec3& b) {
    return b.x * values[vertices[0]] + b.y * values[vertices[1]] + b.z * values[vertices[2]];
}

glm::vec3 normalized_or(const glm::vec3& v, const glm::vec3& otherwise) {
    const float length2 = glm::dot(v, v);
    return length2 > 0.0f && std::isfinite(length2) ? v / std::sqrt(length2) : otherwise;
}

// A smooth normal may lean so far from the face that the eye's ray would be mirrored into the surface. Then the nearest
// normal between it and the face's that mirrors the ray along the surface (1/100 above it) takes its place. In the
// plane of both normals, with the face's as axis, the eye at angle phi and at length r, a normal at angle theta mirrors
// the eye's direction to height r cos(2 theta - phi).
glm::vec3 visible_normal(const glm::vec3& normal, const glm::vec3& face, const glm::vec3& to_eye) {
    const float height = glm::dot(to_eye, face);
    const float least = std::min(0.9f * height, 0.01f);
    if (!(height > 0.0f) || 2.0f * glm::dot(normal, to_eye) * glm::dot(normal, face) - height >= least) return normal;
    const glm::vec3 along = normalized_or(normal - glm::dot(normal, face) * face, glm::vec3(0.0f));
    const float side = glm::dot(to_eye, along), r = std::sqrt(side * side + height * height);
    const float turn = std::acos(std::min(least / r, 1.0f)), phi = std::atan2(side, height);
    const float now = std::atan2(glm::dot(normal, along), glm::dot(normal, face));
    const float theta = std::clamp(now, 0.5f * (phi - turn), 0.5f * (phi + turn));
    return std::sin(theta) * along + std::cos(theta) * face;
}

}  // namespace

ShadedTriangle::ShadedTriangle(const ShadingScene& scene, std::uint32_t triangle)
    : scene_(scene), part_(scene.part_of(triangle)), vertices_(scene.frame().vertices(triangle)) {
    if (part_.material->textured) project(triangle);
    const glm::vec3 &a = part_.positions[vertices_[0]], &b = part_.positions[vertices_[1]],
                    &c = part_.positions[vertices_[2]];
    face_normal_ = normalized_or(glm::cross(b - a, c - a), glm::vec3(0.0f));
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
    }
    const glm::dvec3 rows[3] = {glm::cross(corner[1], corner[2]), glm::cross(corner[2], corner[0]),
                                glm::cross(corner[0], corner[1])};
    const double determinant = glm::dot(corner[0], rows[0]);
    const double scale = determinant != 0.0 ? 1.0 / determinant : 0.0;  // edge-on: no derivatives
    projection_.by_x = scale * glm::dvec3(rows[0].x, rows[1].x, rows[2].x);
    projection_.by_y = scale * glm::dvec3(rows[0].y, rows[1].y, rows[2].y);
}

// One evaluation stands for all samples of its pixel: it is filtered over the pixel (variance 1/12 each way), over the
// whole shutter (1/12) and over the lens disk (1/4 each way).
TextureFootprint ShadedTriangle::footprint(const glm::vec3& barycentrics, int set) const {
    const std::vector<glm::vec2>& uvs = part_.primitive->texcoords[set];
    if (uvs.empty()) return {};
    const glm::dvec3 b(barycentrics);
    const glm::dvec3* corner = projection_.corner;
    const glm::dvec3 point = b.x * corner[0] + b.y * corner[1] + b.z * corner[2];
    if (!(point.z > 0.0)) return {};
    const glm::dvec3 dx =
        point.z * (projection_.by_x - b * (projection_.by_x.x + projection_.by_x.y + projection_.by_x.z));
    const glm::dvec3 dy =
        point.z * (projection_.by_y - b * (projection_.by_y.x + projection_.by_y.y + projection_.by_y.z));
    const glm::dvec2 uv0(uvs[vertices_[0]]);
    const glm::dvec2 edge1 = glm::dvec2(uvs[vertices_[1]]) - uv0, edge2 = glm::dvec2(uvs[vertices_[2]]) - uv0;
    const glm::vec2 by_x(dx.y * edge1 + dx.z * edge2), by_y(dy.y * edge1 + dy.z * edge2);

    const glm::dvec3 motion = b.x * projection_.motion[0] + b.y * projection_.motion[1] + b.z * projection_.motion[2];
    const glm::vec2 velocity((glm::dvec2(motion) - motion.z / point.z * glm::dvec2(point)) / point.z);
    const float coc = static_cast<float>(glm::dot(b, projection_.coc) / point.z);
    const float ratio = static_cast<float>(scene_.frame().view.lens.ratio);

    TextureFootprint footprint;
    const float lens = 0.25f * coc * coc;
    footprint.add(by_x, 1.0f / 12.0f + lens);
    footprint.add(by_y, 1.0f / 12.0f + lens * ratio * ratio);
    footprint.add(by_x * velocity.x + by_y * velocity.y, 1.0f / 12.0f);
    return footprint;
}

// How far the smooth surface bulges out over the facet, along the smooth normal: a parabola over each edge that follows
// the turn of the normals along it (as high as Hanika 2021, Hacking the Shadow Terminator, lifts the point, but nothing
// where normals are merely tilted, as on leaves that are to look like a ball). Facets that are turned away from the
// light though their smooth normals are not do not shadow themselves.
glm::vec3 ShadedTriangle::smooth_offset(const glm::vec3& b, const glm::vec3& normal, bool front) const {
    float height = 0.0f;
    for (int i = 0; i < 3; ++i) {
        const std::uint32_t from = vertices_[i], to = vertices_[(i + 1) % 3];
        const float turn =
            glm::dot(part_.normals[to] - part_.normals[from], part_.positions[to] - part_.positions[from]);
        height += b[i] * b[(i + 1) % 3] * std::max(0.0f, front ? turn : -turn);
    }
    return height * normal;
}

void ShadedTriangle::shade(const glm::vec3& b, bool front, LitColor& out) const {
    out.shadowed.clear();
    out.rest = glm::vec3(0.0f);
    const BoundMaterial& bound = *part_.material;
    const Material& material = bound.material;
    const Primitive& primitive = *part_.primitive;

    glm::vec2 uv[2] = {};
    TextureFootprint footprints[2];
    if (bound.textured)
        for (int set = 0; set < 2; ++set) {
            if (primitive.texcoords[set].empty()) continue;
            uv[set] = interpolate(primitive.texcoords[set], vertices_, b);
            footprints[set] = footprint(b, set);
        }
    const auto look_up = [&](const BoundTexture& texture) {
        return texture.sample(uv[texture.set], footprints[texture.set]);
    };

    glm::vec3 base(material.base_color);
    if (bound.base_color.pyramid) base *= glm::vec3(look_up(bound.base_color));
    if (!primitive.colors.empty()) base *= glm::vec3(interpolate(primitive.colors, vertices_, b));
    if (material.unlit) {
        out.rest = base;
        return;
    }

    float metallic = material.metallic, roughness = material.roughness;
    if (bound.metallic_roughness.pyramid) {
        const glm::vec4 value = look_up(bound.metallic_roughness);
        roughness *= value.y;
        metallic *= value.z;
    }
    const glm::vec3 position = interpolate(part_.positions, vertices_, b);
    const glm::vec3 to_eye = scene_.to_eye(position);
    glm::vec3 normal = normalized_or(interpolate(part_.normals, vertices_, b), to_eye);
    if (!front) normal = -normal;
    normal = visible_normal(normal, front ? face_normal_ : -face_normal_, to_eye);

    const Brdf brdf(base, metallic, roughness, glm::dot(normal, to_eye));
    const Lighting& lighting = scene_.lighting();
    glm::vec3 color = material.emissive;
    if (bound.emissive.pyramid) color *= glm::vec3(look_up(bound.emissive));
    for (std::size_t i = 0; i < lighting.lights.size(); ++i) {
        const Incoming from = incoming(lighting.lights[i], position);
        const float cos_light = glm::dot(normal, from.to_light);
        if (!(cos_light > 0.0f) || from.irradiance == glm::vec3(0.0f)) continue;
        const bool shadowed = scene_.shadows().casts(i);
        const glm::vec3 half = normalized_or(from.to_light + to_eye, normal);
        const glm::vec3 reflected =
            from.irradiance * brdf.reflected(cos_light, std::max(0.0f, glm::dot(normal, half)), glm::dot(to_eye, half));
        if (!shadowed) {
            color += reflected;
            continue;
        }
        const float facing = (front ? 1.0f : -1.0f) * glm::dot(face_normal_, from.to_light);
        const float lift = std::clamp(1.0f - facing / kGrazing, 0.0f, 1.0f);
        out.shadowed.push_back({static_cast<std::uint32_t>(i), reflected,
                                lift > 0.0f ? lift * smooth_offset(b, normal, front) : glm::vec3(0.0f)});
    }
    if (lighting.ambient()) {
        const glm::vec3 mirrored = 2.0f * glm::dot(normal, to_eye) * normal - to_eye;
        glm::vec3 ambient = brdf.diffuse_albedo() * lighting.ambient_towards(normal) +
                            brdf.specular_albedo() * lighting.ambient_towards(mirrored);
        if (bound.occlusion.pyramid)
            ambient *= 1.0f + material.occlusion_strength * (look_up(bound.occlusion).x - 1.0f);
        color += ambient;
    }
    out.rest = color;
    out.position = position;
}

}  // namespace pentaprism
