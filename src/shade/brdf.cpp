#include "shade/brdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace pentaprism {
namespace {

constexpr float kDielectricF0 = 0.04f;
constexpr int kTableSize = 32;
constexpr float kLeastCosine = 1e-3f;

template <typename Real>
Real fifth_power(Real x) {
    return x * x * x * x * x;
}

// Entry (i, j) at roughness i / 31 and cos_view (j / 31)^2: albedo bends most at grazing angles.
using AlbedoTable = std::array<std::array<glm::vec2, kTableSize>, kTableSize>;

double smith_lambda(double cosine, double alpha2) {
    return 0.5 * (std::sqrt(1.0 + alpha2 * (1.0 / (cosine * cosine) - 1.0)) - 1.0);
}

// Integral of the lobe over all light directions by sampling the visible normals (Heitz 2018): what is left to average,
// Fresnel times masking of the light direction, is smooth but for the rim of the disk, where u = 1 - (1 - x)^3 puts
// most points. The other half of the disk is this one's mirror image. Error of the sum below 5e-4.
glm::vec2 integrate_albedo(double cos_view, double roughness) {
    constexpr int kRings = 48, kSectors = 8;
    static const auto directions = [] {
        std::array<glm::dvec2, kSectors> made;
        for (int j = 0; j < kSectors; ++j) {
            const double phi = ((j + 0.5) / kSectors - 0.5) * std::numbers::pi;
            made[j] = {std::cos(phi), std::sin(phi)};
        }
        return made;
    }();
    const double alpha = std::max(roughness, 1e-3) * std::max(roughness, 1e-3), alpha2 = alpha * alpha;
    const double sin_view = std::sqrt(std::max(0.0, 1.0 - cos_view * cos_view));
    const double length = std::sqrt(alpha2 * sin_view * sin_view + cos_view * cos_view);
    const double vx = alpha * sin_view / length, vz = cos_view / length;  // the view stretched to a half sphere
    const double view_lambda = smith_lambda(cos_view, alpha2), lift = 0.5 * (1.0 + vz);
    double constant = 0.0, grazing = 0.0, weights = 0.0;
    for (int i = 0; i < kRings; ++i) {
        const double left = 1.0 - (i + 0.5) / kRings, weight = left * left;
        const double r = std::sqrt(1.0 - left * left * left);
        for (const glm::dvec2& direction : directions) {
            weights += weight;
            const double t1 = r * direction.x, rim = std::sqrt(std::max(0.0, 1.0 - t1 * t1));
            const double t2 = (1.0 - lift) * rim + lift * r * direction.y;
            const double t3 = std::sqrt(std::max(0.0, 1.0 - t1 * t1 - t2 * t2));
            // Frame (y, V x y, V), then back from the half sphere to the ellipsoid.
            glm::dvec3 half(alpha * (vx * t3 - vz * t2), alpha * t1, std::max(0.0, vx * t2 + vz * t3));
            half = glm::normalize(half);
            const double vh = half.x * sin_view + half.z * cos_view, light_z = 2.0 * vh * half.z - cos_view;
            if (!(light_z > 0.0 && vh > 0.0)) continue;
            const double masking = (1.0 + view_lambda) / (1.0 + view_lambda + smith_lambda(light_z, alpha2));
            const double fresnel = fifth_power(1.0 - std::min(vh, 1.0));
            constant += weight * (1.0 - fresnel) * masking;
            grazing += weight * fresnel * masking;
        }
    }
    return {static_cast<float>(constant / weights), static_cast<float>(grazing / weights)};
}

const AlbedoTable& albedo_table() {
    static const AlbedoTable table = [] {
        AlbedoTable made;
        for (int i = 0; i < kTableSize; ++i)
            for (int j = 0; j < kTableSize; ++j) {
                const double root = static_cast<double>(j) / (kTableSize - 1);
                made[i][j] = integrate_albedo(std::max(root * root, 1e-4), static_cast<double>(i) / (kTableSize - 1));
            }
        return made;
    }();
    return table;
}

}  // namespace

std::span<const glm::vec2> specular_albedo_table() {
    return {albedo_table()[0].data(), kTableSize * kTableSize};
}

glm::vec2 specular_albedo(float cos_view, float roughness) {
    const AlbedoTable& table = albedo_table();
    const float x = std::sqrt(std::clamp(cos_view, 0.0f, 1.0f)) * (kTableSize - 1);
    const float y = std::clamp(roughness, 0.0f, 1.0f) * (kTableSize - 1);
    const int j = std::min(static_cast<int>(x), kTableSize - 2), i = std::min(static_cast<int>(y), kTableSize - 2);
    return glm::mix(glm::mix(table[i][j], table[i][j + 1], x - static_cast<float>(j)),
                    glm::mix(table[i + 1][j], table[i + 1][j + 1], x - static_cast<float>(j)),
                    y - static_cast<float>(i));
}

DielectricReflection DielectricReflection::of(float ior, float specular, const glm::vec3& specular_color) {
    const float ratio = ior > 0.0f ? (ior - 1.0f) / (ior + 1.0f) : 1.0f;
    return {glm::min(ratio * ratio * specular_color, glm::vec3(1.0f)) * specular, specular};
}

// The two BRDFs are mixed, not their parameters: a half-metal does not have half of a Fresnel curve.
Brdf::Brdf(const glm::vec3& base, float metallic, float roughness, float cos_view,
           const DielectricReflection& reflection, BrdfModel model)
    : model_(model) {
    roughness_ = roughness = std::clamp(roughness, kLeastRoughness, 1.0f);
    metallic = std::clamp(metallic, 0.0f, 1.0f);
    cos_view_ = std::clamp(cos_view, kLeastCosine, 1.0f);
    alpha2_ = roughness * roughness * roughness * roughness;
    const glm::vec2 albedo = pentaprism::specular_albedo(cos_view_, roughness);
    const float missing = model == BrdfModel::kGltf ? 1.0f / (albedo.x + albedo.y) - 1.0f : 0.0f;

    const glm::vec3 dielectric = 1.0f + reflection.f0 * missing;
    const glm::vec3 dielectric_albedo = dielectric * (reflection.f0 * albedo.x + reflection.f90 * albedo.y);
    const glm::vec3 metal = 1.0f + base * missing;
    const glm::vec3 metal_albedo = metal * (base * albedo.x + albedo.y);

    dielectric_f0_ = reflection.f0;
    dielectric_f90_ = reflection.f90;
    metal_f0_ = base;
    dielectric_scale_ = dielectric * (1.0f - metallic);
    metal_scale_ = metal * metallic;
    // One number for all colours, so that a coloured reflection does not tint what is below with its complement.
    const float reflected = std::max({dielectric_albedo.x, dielectric_albedo.y, dielectric_albedo.z});
    const float left = model == BrdfModel::kGltf ? std::max(0.0f, 1.0f - reflected) : 1.0f;
    diffuse_albedo_ = base * ((1.0f - metallic) * left);
    specular_albedo_ = glm::mix(dielectric_albedo, metal_albedo, metallic);
}

namespace {

struct Ggx {
    float distribution, masking;
};

Ggx ggx(float alpha2, float cos_light, float cos_view, float cos_half) {
    constexpr float kInversePi = static_cast<float>(std::numbers::inv_pi);
    const float base = cos_half * cos_half * (alpha2 - 1.0f) + 1.0f;
    return {alpha2 * kInversePi / (base * base),
            0.5f / (cos_light * std::sqrt(cos_view * cos_view * (1.0f - alpha2) + alpha2) +
                    cos_view * std::sqrt(cos_light * cos_light * (1.0f - alpha2) + alpha2))};
}

}  // namespace

glm::vec3 Brdf::reflected(float cos_light, float cos_half, float cos_difference) const {
    constexpr float kInversePi = static_cast<float>(std::numbers::inv_pi);
    const Ggx lobe = ggx(alpha2_, cos_light, cos_view_, cos_half);
    const float grazing = fifth_power(1.0f - std::clamp(cos_difference, 0.0f, 1.0f));
    const glm::vec3 dielectric = dielectric_f0_ + (dielectric_f90_ - dielectric_f0_) * grazing;
    const glm::vec3 metal = metal_f0_ + (1.0f - metal_f0_) * grazing;
    const glm::vec3 fresnel = dielectric_scale_ * dielectric + metal_scale_ * metal;
    glm::vec3 diffuse = diffuse_albedo_ * kInversePi;
    if (model_ == BrdfModel::kBurley) {
        // Burley 2012: rough surfaces throw light back at grazing angles, smooth ones less.
        const float rim = 2.0f * roughness_ * cos_difference * cos_difference - 0.5f;
        diffuse *= (1.0f + rim * fifth_power(1.0f - cos_light)) * (1.0f + rim * fifth_power(1.0f - cos_view_));
    }
    return (diffuse + lobe.distribution * lobe.masking * fresnel) * cos_light;
}

Coat::Coat(float share, float roughness, float cos_view) {
    roughness = std::clamp(roughness, kLeastRoughness, 1.0f);
    cos_view_ = std::clamp(cos_view, kLeastCosine, 1.0f);
    alpha2_ = roughness * roughness * roughness * roughness;
    const glm::vec2 albedo = pentaprism::specular_albedo(cos_view_, roughness);
    scale_ = share * (1.0f + kDielectricF0 * (1.0f / (albedo.x + albedo.y) - 1.0f));
    albedo_ = scale_ * (kDielectricF0 * albedo.x + albedo.y);
}

float Coat::reflected(float cos_light, float cos_half, float cos_difference) const {
    const Ggx lobe = ggx(alpha2_, cos_light, cos_view_, cos_half);
    const float grazing = fifth_power(1.0f - std::clamp(cos_difference, 0.0f, 1.0f));
    return scale_ * lobe.distribution * lobe.masking * (kDielectricF0 + (1.0f - kDielectricF0) * grazing) * cos_light;
}

namespace {

// Distribution of normals of fibres times masking.
template <typename Real>
Real fibres(Real inverse_alpha, Real cos_light, Real cos_view, Real cos_half) {
    const Real sine2 = std::max(Real(0), Real(1) - cos_half * cos_half);
    const Real distribution =
        (Real(2) + inverse_alpha) * std::pow(sine2, Real(0.5) * inverse_alpha) * Real(0.5 * std::numbers::inv_pi);
    return distribution / (Real(4) * (cos_light + cos_view - cos_light * cos_view));
}

constexpr int kSheenTable = 16;
constexpr float kLeastSheenRoughness = 0.07f;

// Entry (i, j) at roughness i / 15 and cos_view (j / 15)^2. The midpoint rule over the half sphere.
const std::array<std::array<float, kSheenTable>, kSheenTable>& sheen_table() {
    static const auto table = [] {
        constexpr int kRings = 64, kSectors = 32;
        std::array<std::array<float, kSheenTable>, kSheenTable> made{};
        for (int i = 0; i < kSheenTable; ++i)
            for (int j = 0; j < kSheenTable; ++j) {
                const double roughness = std::max<double>(kLeastSheenRoughness, i / (kSheenTable - 1.0));
                const double root = j / (kSheenTable - 1.0), cos_view = std::max(root * root, 1e-3);
                const double sin_view = std::sqrt(1.0 - cos_view * cos_view);
                double sum = 0.0;
                for (int ring = 0; ring < kRings; ++ring)
                    for (int sector = 0; sector < kSectors; ++sector) {
                        const double z = (ring + 0.5) / kRings, r = std::sqrt(1.0 - z * z);
                        const double phi = (sector + 0.5) / kSectors * std::numbers::pi;
                        const glm::dvec3 light(r * std::cos(phi), r * std::sin(phi), z);
                        const glm::dvec3 half = glm::normalize(light + glm::dvec3(sin_view, 0.0, cos_view));
                        sum += fibres(1.0 / (roughness * roughness), z, cos_view, half.z) * z;
                    }
                made[i][j] = static_cast<float>(std::min(1.0, sum * 2.0 * std::numbers::pi / (kRings * kSectors)));
            }
        return made;
    }();
    return table;
}

}  // namespace

std::span<const float> sheen_albedo_table() {
    return {sheen_table()[0].data(), kSheenTable * kSheenTable};
}

float sheen_albedo(float cos_view, float roughness) {
    const auto& table = sheen_table();
    const float x = std::sqrt(std::clamp(cos_view, 0.0f, 1.0f)) * (kSheenTable - 1);
    const float y = std::clamp(roughness, 0.0f, 1.0f) * (kSheenTable - 1);
    const int j = std::min(static_cast<int>(x), kSheenTable - 2), i = std::min(static_cast<int>(y), kSheenTable - 2);
    const float u = x - static_cast<float>(j), v = y - static_cast<float>(i);
    const float low = table[i][j] + (table[i][j + 1] - table[i][j]) * u;
    const float high = table[i + 1][j] + (table[i + 1][j + 1] - table[i + 1][j]) * u;
    return low + (high - low) * v;
}

Sheen::Sheen(const glm::vec3& color, float roughness, float cos_view) : color_(color) {
    roughness = std::clamp(roughness, kLeastSheenRoughness, 1.0f);
    cos_view_ = std::clamp(cos_view, kLeastCosine, 1.0f);
    inverse_alpha_ = 1.0f / (roughness * roughness);
    albedo_ = color * sheen_albedo(cos_view_, roughness);
}

glm::vec3 Sheen::reflected(float cos_light, float cos_half) const {
    return color_ * (fibres(inverse_alpha_, cos_light, cos_view_, cos_half) * cos_light);
}

}  // namespace pentaprism
