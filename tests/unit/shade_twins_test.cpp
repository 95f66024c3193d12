// The vector code of shading against its scalar twins, bit for bit, on each CPU target of the machine.

#include <bit>
#include <gtest/gtest.h>
#include <limits>

#include "shade/light_points.h"
#include "shade/texture_lanes.h"
#include "small_scene.h"
#include "support/isa.h"
#include "support/random.h"

namespace pentaprism {
namespace {

constexpr const char* kTargets[] = {"avx512", "avx2", "neon", "scalar"};

Image random_image(support::Random& random, int width, int height) {
    std::vector<std::uint8_t> texels(4 * static_cast<std::size_t>(width) * height);
    for (std::uint8_t& code : texels) code = static_cast<std::uint8_t>(random.bits());
    return {"test", width, height, texels};
}

glm::vec3 random_vector(support::Random& random) {
    return glm::vec3(random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0));
}

TextureFootprint random_footprint(support::Random& random) {
    TextureFootprint footprint;
    if (random.chance(0.1)) return footprint;
    for (int axis = 0; axis < 2; ++axis)
        footprint.add(glm::vec2(random_vector(random)), static_cast<float>(random.magnitude(1e-8, 1.0)));
    if (random.chance(0.05)) footprint.uu = std::numeric_limits<float>::infinity();
    return footprint;
}

bool same_bits(float a, float b) {
    return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

TEST(ShadeTwins, TexturesOfSixteenPointsAreThoseOfEach) {
    support::Random random(1);
    int targets = 0, fractions = 0;
    for (const char* target : kTargets) {
        if (!support::has_isa(target)) continue;
        ++targets;
        const support::UseIsa use(target);
        const SampleTextureLanes sample = sample_texture_lanes();
        for (int round = 0; round < 300; ++round) {
            const int width = random.between(1, 70), height = random.between(1, 70);
            const Pyramid pyramid(random_image(random, width, height),
                                  random.chance(0.5) ? Encoding::kSrgb : Encoding::kLinear, random.chance(0.5));
            constexpr Wrap kWraps[] = {Wrap::kRepeat, Wrap::kMirroredRepeat, Wrap::kClampToEdge};
            BoundTexture texture;
            texture.pyramid = &pyramid;
            texture.ref.wrap_s = kWraps[random.below(3)];
            texture.ref.wrap_t = kWraps[random.below(3)];
            texture.ref.offset = glm::vec2(random_vector(random));
            texture.ref.scale = glm::vec2(random_vector(random)) * 3.0f;
            texture.ref.rotation = static_cast<float>(random.below(2));
            texture.matrix = uv_matrix(texture.ref);
            texture.set = random.below(2);
            PointBatch batch;
            batch.count = random.between(1, PointBatch::kLanes);
            for (int lane = 0; lane < batch.count; ++lane) {
                SurfacePoint point;
                for (int set = 0; set < 2; ++set) {
                    point.uv[set] = glm::vec2(random_vector(random)) * static_cast<float>(random.magnitude(0.1, 1e3));
                    if (random.chance(0.1)) point.uv[set].x = static_cast<float>(random.between(-2, 2));
                    point.footprint[set] = random_footprint(random);
                }
                if (random.chance(0.02)) point.uv[0].x = std::numeric_limits<float>::quiet_NaN();
                batch.set(lane, point);
            }
            const int first = random.below(4), channels = random.between(1, 4 - first);
            alignas(64) PointBatch::Lanes out[4];
            sample({&texture, &batch, first, channels, out});
            for (int lane = 0; lane < batch.count; ++lane) {
                const SurfacePoint point = batch.get(lane);
                const glm::vec4 exact = texture.sample(point.uv[texture.set], point.footprint[texture.set]);
                for (int k = 0; k < channels; ++k) {
                    ASSERT_TRUE(same_bits(out[k][lane], exact[first + k]))
                        << target << " round " << round << ": " << out[k][lane] << " not " << exact[first + k];
                    fractions += exact[first + k] > 0.0f && exact[first + k] < 1.0f;
                }
            }
        }
    }
    EXPECT_GT(targets, 0);
    EXPECT_GT(fractions, 1000);
}

// Lights of all kinds, and materials of one layer with all their textures and with none.
Scene scene_of_all(support::Random& random) {
    Scene scene = small_scene::scene_with_camera();
    for (int i = 0; i < 5; ++i) {
        Light light;
        light.kind = i < 2 ? LightKind::kDirectional : i < 4 ? LightKind::kPoint : LightKind::kSpot;
        light.intensity = static_cast<float>(random.range(1.0, 9.0));
        light.color = glm::abs(random_vector(random));
        if (i == 3) light.range = 4.0f;
        light.inner_cone = 0.3f;
        light.outer_cone = 0.9f;
        Transform transform;
        transform.translation = glm::dvec3(random_vector(random)) + glm::dvec3(0.0, 0.0, -1.0);
        small_scene::add_light(scene, light, transform);
    }
    scene.images.push_back(random_image(random, 16, 8));
    for (int i = 0; i < 12; ++i) {
        Material material;
        material.base_color = glm::vec4(glm::abs(random_vector(random)), 1.0f);
        material.metallic = static_cast<float>(random.biased());
        material.roughness = static_cast<float>(random.biased());
        material.emissive = i % 2 == 0 ? glm::abs(random_vector(random)) : glm::vec3(0.0f);
        material.unlit = i == 11;
        if (i % 3 == 1) {
            material.ior = static_cast<float>(random.range(1.0, 2.5));
            material.specular = static_cast<float>(random.unit());
            material.specular_color = glm::abs(random_vector(random));
        }
        if (i >= 4)
            for (TextureRef* ref : {&material.base_color_texture, &material.metallic_roughness_texture,
                                    &material.normal_texture, &material.occlusion_texture, &material.emissive_texture,
                                    &material.specular_texture, &material.specular_color_texture})
                if (random.chance(0.7)) ref->image = 0;
        material.normal_scale = 0.7f;
        material.occlusion_strength = 0.6f;
        scene.materials.push_back(material);
        small_scene::add_mesh(scene, {small_scene::square(0.5f, -2.0f - static_cast<float>(i), i)});
    }
    return scene;
}

SurfacePoint random_point(support::Random& random) {
    SurfacePoint point;
    point.position = random_vector(random) * 3.0f + glm::vec3(0.0f, 0.0f, -4.0f);
    if (random.chance(0.02)) point.position = glm::vec3(0.0f);
    point.face = glm::normalize(random_vector(random) + glm::vec3(0.0f, 0.0f, 1.0f));
    point.front = random.chance(0.7);
    point.normal = 0.9f * (point.front ? point.face : -point.face) + 0.4f * random_vector(random);
    if (random.chance(0.02)) point.normal = glm::vec3(0.0f);
    point.has_tangent = random.chance(0.8);
    point.tangent = glm::vec4(random_vector(random), static_cast<float>(random.sign()));
    if (random.chance(0.5)) point.color = glm::abs(random_vector(random));
    for (int set = 0; set < 2; ++set) {
        point.uv[set] = glm::vec2(random_vector(random));
        point.footprint[set] = random_footprint(random);
    }
    point.bulge = static_cast<float>(random.unit());
    return point;
}

TEST(ShadeTwins, SixteenPointsAreLitAsEach) {
    support::Random random(2);
    const Scene scene = scene_of_all(random);
    const Frame frame = small_scene::frame_of(scene, RenderSettings{});
    const Environment::Map half_white{4,
                                      2,
                                      {glm::vec3(0.9f), glm::vec3(0.8f), glm::vec3(0.7f), glm::vec3(0.6f),
                                       glm::vec3(0.1f), glm::vec3(0.2f), glm::vec3(0.3f), glm::vec3(0.2f)}};
    int targets = 0, shares = 0, lifted = 0;
    for (const char* target : kTargets) {
        if (!support::has_isa(target)) continue;
        ++targets;
        const support::UseIsa use(target);
        LightPoints light_points;
        for (const bool environment : {false, true})
            for (const BrdfModel model : {BrdfModel::kGltf, BrdfModel::kBurley})
                for (const ShadowMode shadows : {ShadowMode::kMoving, ShadowMode::kOff}) {
                    ShadingOptions options;
                    options.brdf = model;
                    options.shadows = shadows;
                    if (environment) options.environment = std::make_shared<const Environment>(half_white);
                    const ShadingScene shading(frame, options);
                    for (const BoundMaterial& material : shading.materials()) {
                        ASSERT_FALSE(material.layered);
                        PointBatch batch;
                        batch.material = &material;
                        batch.count = random.between(1, PointBatch::kLanes);
                        for (int lane = 0; lane < batch.count; ++lane) batch.set(lane, random_point(random));
                        LitBatch lit;
                        light_points.light(shading, batch, lit);
                        for (int lane = 0; lane < batch.count; ++lane) {
                            LitColor exact, found;
                            light_point(shading, material, batch.get(lane), exact);
                            lit.get(batch, lane, found);
                            for (int k = 0; k < 3; ++k)
                                ASSERT_TRUE(same_bits(found.rest[k], exact.rest[k]))
                                    << target << ' ' << found.rest[k] << " not " << exact.rest[k];
                            ASSERT_EQ(found.shadowed.size(), exact.shadowed.size()) << target;
                            for (std::size_t i = 0; i < exact.shadowed.size(); ++i) {
                                const LitColor::Share &a = found.shadowed[i], &b = exact.shadowed[i];
                                ASSERT_EQ(a.light, b.light);
                                for (int k = 0; k < 3; ++k) {
                                    ASSERT_TRUE(same_bits(a.color[k], b.color[k])) << target;
                                    ASSERT_TRUE(same_bits(a.offset[k], b.offset[k])) << target;
                                }
                                ++shares;
                                lifted += b.offset != glm::vec3(0.0f);
                            }
                        }
                    }
                }
    }
    EXPECT_GT(targets, 0);
    EXPECT_GT(shares, 200);
    EXPECT_GT(lifted, 20);
}

}  // namespace
}  // namespace pentaprism
