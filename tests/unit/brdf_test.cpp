#include "shade/brdf.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <numbers>

namespace pentaprism {
namespace {

// Light of radiance 1 from all directions, reflected to one: integral of BRDF * cos over the half sphere. The lobe is
// narrow around the mirror direction, so half vectors are sampled: those of GGX, weighted by the Jacobian 4 v.h.
template <typename Reflected>
double furnace(double cos_view, double roughness, const Reflected& reflected) {
    constexpr int kRings = 400, kSectors = 180;
    const glm::dvec3 view(std::sqrt(1.0 - cos_view * cos_view), 0.0, cos_view);
    const double alpha2 = std::pow(roughness, 4.0);
    double sum = 0.0;
    for (int i = 0; i < kRings; ++i)
        for (int j = 0; j < kSectors; ++j) {
            // Half of the points by GGX, half by cosine for the diffuse part: the balance heuristic joins them.
            const double xi = (i + 0.5) / kRings, phi = 2.0 * std::numbers::pi * (j + 0.5) / kSectors;
            for (const bool by_lobe : {true, false}) {
                glm::dvec3 half, light;
                if (by_lobe) {
                    const double cosine = std::sqrt((1.0 - xi) / (1.0 + (alpha2 - 1.0) * xi)),
                                 sine = std::sqrt(1.0 - cosine * cosine);
                    half = {sine * std::cos(phi), sine * std::sin(phi), cosine};
                    light = 2.0 * glm::dot(view, half) * half - view;
                } else {
                    light = {std::sqrt(xi) * std::cos(phi), std::sqrt(xi) * std::sin(phi), std::sqrt(1.0 - xi)};
                    half = glm::normalize(light + view);
                }
                if (light.z <= 0.0) continue;
                const double nh = half.z, vh = glm::dot(view, half), base = nh * nh * (alpha2 - 1.0) + 1.0;
                const double lobe = alpha2 / (std::numbers::pi * base * base) * nh / (4.0 * vh);
                const double density = 0.5 * (lobe + light.z / std::numbers::pi);
                sum += 0.5 * reflected(light.z, nh, vh) / density;
            }
        }
    return sum / (kRings * kSectors);
}

double furnace(const Brdf& brdf, double cos_view, double roughness) {
    return furnace(cos_view, roughness, [&](double nl, double nh, double vh) {
        return brdf.reflected(static_cast<float>(nl), static_cast<float>(nh), static_cast<float>(vh)).x;
    });
}

// Single-scattering albedo for F = 1, height-correlated GGX: this project's quadrature (docs/learn/shading.md).
TEST(Brdf, TheAlbedoTableHoldsTheValuesOfTheQuadrature) {
    const struct {
        float roughness, albedo[4];
    } rows[] = {{0.1f, {.994f, 1.000f, 1.000f, 1.000f}},
                {0.5f, {.892f, .844f, .897f, .916f}},
                {0.75f, {.848f, .687f, .630f, .627f}},
                {1.0f, {.760f, .499f, .351f, .307f}}};
    const float cosines[4] = {0.1f, 0.4f, 0.8f, 1.0f};
    for (const auto& row : rows)
        for (int i = 0; i < 4; ++i) {
            const glm::vec2 e = specular_albedo(cosines[i], row.roughness);
            EXPECT_NEAR(e.x + e.y, row.albedo[i], 0.005f) << row.roughness << ' ' << cosines[i];
        }
}

TEST(Brdf, AWhiteMetalReflectsAllLightAtAnyRoughness) {
    for (const float roughness : {0.1f, 0.3f, 0.5f, 0.75f, 1.0f})
        for (const float cos_view : {0.05f, 0.1f, 0.4f, 0.8f, 0.999f})
            EXPECT_NEAR(furnace(Brdf(glm::vec3(1.0f), 1.0f, roughness, cos_view), cos_view, roughness), 1.0, 0.006)
                << roughness << ' ' << cos_view;
}

TEST(Brdf, AWhiteDielectricReflectsAllLightAndNoMore) {
    for (const float roughness : {0.1f, 0.3f, 0.5f, 0.75f, 1.0f})
        for (const float cos_view : {0.05f, 0.1f, 0.4f, 0.8f, 0.999f})
            EXPECT_NEAR(furnace(Brdf(glm::vec3(1.0f), 0.0f, roughness, cos_view), cos_view, roughness), 1.0, 0.006)
                << roughness << ' ' << cos_view;
}

TEST(Brdf, TheAlbedosAreWhatTheFurnaceShows) {
    for (const float metallic : {0.0f, 0.3f, 1.0f}) {
        const Brdf brdf(glm::vec3(0.5f), metallic, 0.6f, 0.7f);
        EXPECT_NEAR(furnace(brdf, 0.7, 0.6), brdf.diffuse_albedo().x + brdf.specular_albedo().x, 0.006) << metallic;
    }
}

TEST(Brdf, BlackDielectricsStillShine) {
    const Brdf black(glm::vec3(0.0f), 0.0f, 0.5f, 1.0f);
    EXPECT_EQ(black.diffuse_albedo(), glm::vec3(0.0f));
    EXPECT_NEAR(furnace(black, 0.999, 0.5), 0.04, 0.01);
}

TEST(Brdf, ADielectricOfAnyReflectionReflectsAllLightAndNoMoreIfItIsWhite) {
    const DielectricReflection glass = DielectricReflection::of(1.9f, 1.0f, glm::vec3(1.0f));
    const DielectricReflection dull = DielectricReflection::of(1.5f, 0.3f, glm::vec3(1.0f));
    EXPECT_NEAR(glass.f0.x, 0.0963f, 1e-4f);
    EXPECT_NEAR(dull.f0.x, 0.012f, 1e-6f);
    EXPECT_EQ(DielectricReflection::of(0.0f, 1.0f, glm::vec3(1.0f)).f0, glm::vec3(1.0f));
    for (const DielectricReflection& reflection : {glass, dull})
        for (const float roughness : {0.1f, 0.5f, 1.0f})
            for (const float cos_view : {0.1f, 0.4f, 0.999f})
                EXPECT_NEAR(furnace(Brdf(glm::vec3(1.0f), 0.0f, roughness, cos_view, reflection), cos_view, roughness),
                            1.0, 0.006)
                    << roughness << ' ' << cos_view;
}

TEST(Brdf, ACoatThrowsBackItsAlbedo) {
    for (const float roughness : {0.1f, 0.4f, 0.9f})
        for (const float cos_view : {0.1f, 0.5f, 0.999f}) {
            const Coat coat(0.8f, roughness, cos_view);
            const double shown = furnace(cos_view, roughness, [&](double nl, double nh, double vh) {
                return coat.reflected(static_cast<float>(nl), static_cast<float>(nh), static_cast<float>(vh));
            });
            EXPECT_NEAR(shown, coat.albedo(), 0.006) << roughness << ' ' << cos_view;
        }
}

TEST(Brdf, SheenThrowsBackItsAlbedo) {
    for (const float roughness : {0.2f, 0.5f, 1.0f})
        for (const float cos_view : {0.1f, 0.5f, 0.999f}) {
            const Sheen sheen(glm::vec3(0.7f), roughness, cos_view);
            const double shown = furnace(cos_view, 1.0, [&](double nl, double nh, double) {
                return sheen.reflected(static_cast<float>(nl), static_cast<float>(nh)).x;
            });
            EXPECT_NEAR(shown, sheen.albedo().x, 0.02) << roughness << ' ' << cos_view;
            EXPECT_LE(sheen.albedo().x, 0.7f);
        }
}

TEST(Brdf, TheLobeIsReciprocal) {
    const float a = 0.3f, b = 0.9f, nh = 0.95f, vh = 0.8f;
    const Brdf from_a(glm::vec3(0.0f), 1.0f, 0.4f, a), from_b(glm::vec3(0.0f), 1.0f, 0.4f, b);
    EXPECT_NEAR(from_a.reflected(b, nh, vh).x / b, from_b.reflected(a, nh, vh).x / a, 1e-6f);
}

}  // namespace
}  // namespace pentaprism
