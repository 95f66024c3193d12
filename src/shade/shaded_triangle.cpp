#include "shade/shaded_triangle.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "frame/opacity.h"
#include "shade/brdf.h"

namespace pentaprism {
namespace {

// Cosine of face and light below which points are lifted to the smooth surface, little by little.
constexpr float kGrazing = 0.1f;
// Cosine between a facet and the normals at its corners: up to here it stands for a smooth surface, from here not.
constexpr float kSmooth = 0.5f, kSpread = 0.25f;

constexpr float kNegligible = 1.0f / 512.0f;

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
// where normals merely spread, as on leaves that are to look like a ball: those lean far from the facet). Facets that
// are turned away from the light though their smooth normals are not do not shadow themselves.
glm::vec3 ShadedTriangle::smooth_offset(const glm::vec3& b, const glm::vec3& normal, bool front) const {
    float height = 0.0f, least = 1.0f;
    for (int i = 0; i < 3; ++i) {
        least = std::min(least, glm::dot(part_.normals[vertices_[i]], face_normal_));
        const std::uint32_t from = vertices_[i], to = vertices_[(i + 1) % 3];
        const float turn =
            glm::dot(part_.normals[to] - part_.normals[from], part_.positions[to] - part_.positions[from]);
        height += b[i] * b[(i + 1) % 3] * std::max(0.0f, front ? turn : -turn);
    }
    return std::clamp((least - kSpread) / (kSmooth - kSpread), 0.0f, 1.0f) * height * normal;
}

namespace {

// The normal of a texel, x and y scaled: unit, or as long as filtering left it.
glm::vec3 decoded_normal(const glm::vec4& texel, float scale) {
    return {(2.0f * texel.x - 1.0f) * scale, (2.0f * texel.y - 1.0f) * scale, 2.0f * texel.z - 1.0f};
}

// What a surface does with the light of one direction.
class Surface {
  public:
    Surface(const Brdf& brdf, float roughness, const glm::vec3& normal, const glm::vec3& to_eye)
        : brdf_(brdf), roughness_(roughness), normal_(normal), to_eye_(to_eye) {}

    void add_coat(float share, float roughness, const glm::vec3& normal) {
        coat_normal_ = normal;
        coat_roughness_ = roughness;
        coat_ = Coat(share, roughness, glm::dot(normal, to_eye_));
        below_ *= 1.0f - coat_->albedo();
    }
    void add_sheen(const glm::vec3& color, float roughness) {
        sheen_ = Sheen(color, roughness, glm::dot(normal_, to_eye_));
        sheen_scale_ = below_;
        const glm::vec3& albedo = sheen_->albedo();
        below_ *= 1.0f - std::max({albedo.x, albedo.y, albedo.z});
    }

    // Reflected radiance over irradiance perpendicular to the ray; black from behind.
    glm::vec3 reflected(const glm::vec3& to_light) const {
        const glm::vec3 half = normalized_or(to_light + to_eye_, normal_);
        const float cos_difference = glm::dot(to_eye_, half);
        const auto cos_half = [&](const glm::vec3& n) { return std::max(0.0f, glm::dot(n, half)); };
        glm::vec3 color(0.0f);
        if (const float cos_light = glm::dot(normal_, to_light); cos_light > 0.0f) {
            color = below_ * brdf_.reflected(cos_light, cos_half(normal_), cos_difference);
            if (sheen_) color += sheen_scale_ * sheen_->reflected(cos_light, cos_half(normal_));
        }
        if (!coat_) return color;
        if (const float cos_light = glm::dot(coat_normal_, to_light); cos_light > 0.0f)
            color += coat_->reflected(cos_light, cos_half(coat_normal_), cos_difference);
        return color;
    }
    // The same of light from all sides.
    glm::vec3 ambient(const Lighting& lighting) const {
        const auto mirrored = [&](const glm::vec3& n) { return 2.0f * glm::dot(n, to_eye_) * n - to_eye_; };
        glm::vec3 color = brdf_.diffuse_albedo() * lighting.matte(normal_) +
                          brdf_.specular_albedo() * lighting.shiny(mirrored(normal_), roughness_);
        color *= below_;
        if (sheen_) color += sheen_scale_ * sheen_->albedo() * lighting.matte(normal_);
        if (coat_) color += coat_->albedo() * lighting.shiny(mirrored(coat_normal_), coat_roughness_);
        return color;
    }

    // Of what is not reflected by a coat or by fibres.
    float below() const { return below_; }

  private:
    Brdf brdf_;
    float roughness_, coat_roughness_ = 0.0f;
    glm::vec3 normal_, to_eye_, coat_normal_{0.0f};
    std::optional<Coat> coat_;
    std::optional<Sheen> sheen_;
    float below_ = 1.0f, sheen_scale_ = 1.0f;
};

}  // namespace

// Mapped normals live in the frame (tangent, bitangent, normal) of the interpolated vectors as they are; the result
// alone is made unit (as MikkTSpace asks).
glm::vec3 ShadedTriangle::mapped_normal(const glm::vec3& b, const glm::vec3& map) const {
    const glm::vec3 normal = interpolate(part_.normals, vertices_, b);
    const glm::vec4 tangent = interpolate(part_.tangents, vertices_, b);
    const glm::vec3 along(tangent);
    return map.x * along + map.y * (glm::cross(normal, along) * tangent.w) + map.z * normal;
}

void ShadedTriangle::shade(const glm::vec3& barycentrics, bool front, const ShadingCell& cell, LitColor& out) const {
    out.shadowed.clear();
    out.rest = glm::vec3(0.0f);
    const BoundMaterial& bound = *part_.material;
    const Material& material = bound.material;
    const Primitive& primitive = *part_.primitive;
    const glm::vec3 b = scene_.frame().in_source(triangle_, barycentrics);  // of vertices_

    glm::vec2 uv[2] = {};
    TextureFootprint footprints[2];
    if (bound.textured)
        for (int set = 0; set < 2; ++set) {
            if (primitive.texcoords[set].empty()) continue;
            uv[set] = interpolate(primitive.texcoords[set], vertices_, b);
            footprints[set] = footprint(barycentrics, set, cell);
        }
    const auto look_up = [&](const BoundTexture& texture) {
        return texture.pyramid ? texture.sample(uv[texture.set], footprints[texture.set]) : glm::vec4(1.0f);
    };

    glm::vec3 base = glm::vec3(material.base_color) * glm::vec3(look_up(bound.base_color));
    if (!primitive.colors.empty()) base *= glm::vec3(interpolate(primitive.colors, vertices_, b));
    if (material.unlit) {
        out.rest = base;
        return;
    }

    const glm::vec4 metallic_roughness = look_up(bound.metallic_roughness);
    const float metallic = material.metallic * metallic_roughness.z;
    const float roughness = material.roughness * metallic_roughness.y;
    const glm::vec3 position = interpolate(part_.positions, vertices_, b);
    const glm::vec3 to_eye = scene_.to_eye(position), face = front ? face_normal_ : -face_normal_;
    const auto towards_eye = [&](const glm::vec3& n) {
        const glm::vec3 unit = normalized_or(n, to_eye);
        return front ? unit : -unit;
    };
    const auto seen = [&](const glm::vec3& n) { return visible_normal(towards_eye(n), face, to_eye); };
    const bool mapped = !part_.tangents.empty();
    const glm::vec3 smooth_given = towards_eye(interpolate(part_.normals, vertices_, b));
    const glm::vec3 smooth = visible_normal(smooth_given, face, to_eye);
    const glm::vec3 given =
        bound.normal.pyramid && mapped
            ? towards_eye(mapped_normal(b, decoded_normal(look_up(bound.normal), material.normal_scale)))
            : smooth_given;
    const glm::vec3 normal = visible_normal(given, face, to_eye);

    DielectricReflection reflection;
    if (material.ior != 1.5f || material.specular != 1.0f || material.specular_color != glm::vec3(1.0f) ||
        bound.specular.pyramid || bound.specular_color.pyramid)
        reflection = DielectricReflection::of(material.ior, material.specular * look_up(bound.specular).w,
                                              material.specular_color * glm::vec3(look_up(bound.specular_color)));
    float passed = 0.0f;  // of the light that would be scattered below the surface
    if (material.transmission > 0.0f)
        passed = material.transmission * look_up(bound.transmission).x * (1.0f - metallic);
    Brdf brdf(base, metallic, roughness, glm::dot(normal, to_eye), reflection, scene_.options().brdf);
    brdf.scale_diffuse(1.0f - passed);
    Surface surface(brdf, roughness, normal, to_eye);
    if (bound.layered) {
        if (const float coat = material.clearcoat * look_up(bound.coat).x; coat > 0.0f) {
            const glm::vec3 coat_normal = bound.coat_normal.pyramid && mapped
                                              ? seen(mapped_normal(b, decoded_normal(look_up(bound.coat_normal),
                                                                                     material.clearcoat_normal_scale)))
                                              : smooth;
            surface.add_coat(coat, material.clearcoat_roughness * look_up(bound.coat_roughness).y, coat_normal);
        }
        const glm::vec3 sheen = material.sheen_color * glm::vec3(look_up(bound.sheen_color));
        if (sheen != glm::vec3(0.0f))
            surface.add_sheen(sheen, material.sheen_roughness * look_up(bound.sheen_roughness).w);
    }
    // The samples that see through say nothing of what the surface reflects: the others speak for them.
    const float scale = material.transmission > 0.0f
                            ? 1.0f / (1.0f - see_through(material.transmission * look_up(bound.transmission).x))
                            : 1.0f;

    const Lighting& lighting = scene_.lighting();
    glm::vec3 color = surface.below() * material.emissive * glm::vec3(look_up(bound.emissive));
    for (std::size_t i = 0; i < lighting.lights.size(); ++i) {
        const Incoming from = incoming(lighting.lights[i], position);
        if (from.irradiance == glm::vec3(0.0f)) continue;
        if (normal != given && glm::dot(given, from.to_light) <= 0.0f) continue;  // bending must not reach the light
        const glm::vec3 reflected = from.irradiance * surface.reflected(from.to_light);
        if (reflected == glm::vec3(0.0f)) continue;
        if (!scene_.shadows().casts(i)) {
            color += reflected;
            continue;
        }
        const float lift = std::clamp(1.0f - glm::dot(face, from.to_light) / kGrazing, 0.0f, 1.0f);
        out.shadowed.push_back({static_cast<std::uint32_t>(i), scale * reflected,
                                lift > 0.0f ? lift * smooth_offset(b, smooth, front) : glm::vec3(0.0f)});
    }
    if (lighting.ambient()) {
        glm::vec3 ambient = surface.ambient(lighting);
        if (bound.occlusion.pyramid)
            ambient *= 1.0f + material.occlusion_strength * (look_up(bound.occlusion).x - 1.0f);
        color += ambient;
    }
    out.rest = scale * color;
    out.position = position;

    // A light that adds less than half a code of 8 bits to what the point shows needs no shadow.
    const auto brightness = [](const glm::vec3& c) { return c.x + c.y + c.z; };
    float total = brightness(out.rest);
    for (const LitColor::Share& share : out.shadowed) total += brightness(share.color);
    std::erase_if(out.shadowed, [&](const LitColor::Share& share) {
        if (brightness(share.color) > kNegligible * total) return false;
        out.rest += share.color;
        return true;
    });
}

}  // namespace pentaprism
