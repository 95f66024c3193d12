// The GLSL twins of shading answer as the C++ functions do, question by question, within a few units in the last place:
// drivers are free to round quotients, roots, powers and angles in their own way.

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <pentaprism/error.h>
#include <pentaprism/settings.h>

#include "camera/lens.h"
#include "gl/device.h"
#include "gl/shading_upload.h"
#include "peer/posed_picture.h"
#include "shade/brdf.h"
#include "shade/environment.h"
#include "support/random.h"
#include "support/scenes.h"

namespace pentaprism {
namespace {

using gl::Buffer;
using gl::Device;
using gl::Program;
using support::Random;

constexpr int kQuestions = 1 << 14, kTextures = 12;

constexpr const char* kShader = R"(
layout(local_size_x = 64) in;
#include "shade/shaded_triangle.glsl"
struct Question {
    vec4 base, angles, more, direction, position, place, footprint;
    vec4 answers[7];
};
layout(std430, binding = 1) restrict buffer Questions { Question questions[]; };

void main() {
    uint i = item_index();
    Question k = questions[i];
    float cos_view = k.angles.y, cos_light = k.angles.z, cos_half = k.angles.w, cos_difference = k.more.x;
    Brdf brdf = make_brdf(k.base.rgb, k.base.w, k.angles.x, cos_view,
                          dielectric_reflection(k.more.y, k.more.z, k.base.bgr));
    Coat coat = make_coat(k.direction.w, k.angles.x, cos_view);
    Sheen sheen = make_sheen(k.base.rgb, k.more.w, cos_view);
    vec2 albedo = specular_albedo(cos_view, k.angles.x);
    Incoming from = incoming(lights[i % uint(light_count)], k.position.xyz);
    BoundTexture texture = materials[0].textures[kBaseColor];
    for (int m = 0; m < 12; ++m)
        if (m == int(k.place.z)) texture = materials[m].textures[m % 2 == 0 ? kBaseColor : kOcclusion];
    questions[i].answers[0] =
        vec4(brdf_reflected(brdf, cos_light, cos_half, cos_difference), coat_reflected(coat, cos_light, cos_half, cos_difference));
    questions[i].answers[1] = vec4(sheen_reflected(sheen, cos_light, cos_half), sheen_albedo(cos_view, k.more.w));
    questions[i].answers[2] = vec4(environment_matte(k.direction.xyz), albedo.x);
    questions[i].answers[3] = vec4(environment_shiny(k.direction.xyz, k.angles.x), albedo.y);
    questions[i].answers[4] = vec4(from.irradiance, float(lens_coc(double(k.footprint.w))));
    questions[i].answers[5] = vec4(from.to_light, shadow_texel(k.position.xyz));
    questions[i].answers[6] = sample_texture(texture, k.place.xy, k.footprint.xyz);
}
)";

struct Question {
    glm::vec4 base, angles, more, direction, position, place, footprint, answers[7];
};

// Squares with textures of odd sizes, filters, edges and transforms; each kind of light.
Scene scene_of_all() {
    Scene scene;
    scene.name = "all";
    support::add_camera(scene, "camera", {0, 0, 3});
    Random r(11);
    for (const auto& [width, height] : {std::pair(64, 64), std::pair(37, 5), std::pair(1, 9)}) {
        Image& image = scene.images.emplace_back();
        image.width = width, image.height = height;
        for (int i = 0; i < 4 * width * height; ++i) image.texels.push_back(static_cast<std::uint8_t>(r.below(256)));
    }
    for (int i = 0; i < kTextures; ++i) {
        const Index node = support::add_square(scene, "square", {0, 0, -i}, 1);
        Primitive& primitive = scene.meshes[scene.nodes[node].mesh].primitives[0];
        primitive.texcoords[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        primitive.material = i;
        Material& material = scene.materials.emplace_back();
        TextureRef& ref = i % 2 == 0 ? material.base_color_texture : material.occlusion_texture;
        ref.image = i % 3;
        ref.wrap_s = static_cast<Wrap>(i % 3), ref.wrap_t = static_cast<Wrap>(i / 2 % 3);
        ref.nearest = i % 4 == 3, ref.mipmapped = i != 7;
        if (i > 5) ref.rotation = 0.7f, ref.offset = {0.3f, -1.2f}, ref.scale = {2.5f, 0.4f};
    }
    for (const LightKind kind : {LightKind::kDirectional, LightKind::kPoint, LightKind::kSpot, LightKind::kSpot}) {
        Light& light = scene.lights.emplace_back();
        light.kind = kind;
        light.color = {1.0f, 0.7f, 0.4f};
        light.intensity = 7.0f;
        light.outer_cone = 0.9f, light.inner_cone = 0.3f;
        if (scene.lights.size() == 4) light.range = 4.0f;
        const Index node = support::add_node(scene, "light", {0.5 * static_cast<double>(scene.lights.size()), 1, 1});
        scene.nodes[node].light = static_cast<Index>(scene.lights.size()) - 1;
    }
    return scene;
}

glm::vec3 random_direction(Random& r) {
    for (;;) {
        const glm::vec3 d(r.range(-1, 1), r.range(-1, 1), r.range(-1, 1));
        const float length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
        if (length > 0.1f && length < 1.0f) return d / length;
    }
}

Question random_question(Random& r, int i) {
    const auto unit = [&] { return static_cast<float>(r.unit()); };
    Question k{};
    k.base = {unit(), unit(), unit(), unit()};
    k.angles = {i % 7 == 0 ? 0.0f : unit(), std::max(1e-3f, unit() * unit()), std::max(1e-3f, unit()), unit()};
    k.more = {unit(), r.chance(0.1) ? 0.0f : static_cast<float>(r.range(1, 2.5)), unit(), unit()};
    k.direction = glm::vec4(random_direction(r), unit());
    k.position = {r.range(-3, 3), r.range(-3, 3), r.range(-3, 3), 0};
    k.place = {r.range(-3, 3), r.range(-3, 3), r.below(kTextures), 0};
    // A footprint from a point to far more than the texture, round or long.
    const float a = std::exp2(static_cast<float>(r.range(-12, 2))), b = std::exp2(static_cast<float>(r.range(-12, 2)));
    TextureFootprint f;
    f.add({a, unit() * a}, 1.0f);
    if (i % 3 != 0) f.add({-unit() * b, b}, 1.0f);
    if (i % 11 == 0) f = {};
    k.footprint = {f.uu, f.uv, f.vv, std::exp2(r.range(-5, 6))};
    return k;
}

// The largest difference of each kind, relative to what is compared or to 1, whichever is larger.
struct Worst {
    double of[7] = {}, of_w[7] = {};
    static double off(float a, float b) { return std::abs(a - b) / std::max(1.0f, std::abs(a)); }
    void add(int kind, const glm::vec3& cpu, float w, const glm::vec4& gl) {
        for (int c = 0; c < 3; ++c) of[kind] = std::max(of[kind], off(cpu[c], gl[c]));
        of_w[kind] = std::max(of_w[kind], off(w, gl.w));
    }
};

class GlShadeTwins : public testing::TestWithParam<bool> {
  protected:
    void SetUp() override {
        try {
            device_ = &Device::get();
        } catch (const Error& error) {
            GTEST_SKIP() << error.what();
        }
    }
    Device* device_ = nullptr;
};

TEST_P(GlShadeTwins, AnswerAsTheFunctionsOfTheProcessor) {
    const Scene scene = scene_of_all();
    RenderSettings settings;
    settings.camera.fstop = 1.4;
    if (GetParam()) {
        settings.camera.focus_range = {{2.0, 4.0}};
        settings.camera.max_foreground_blur = 9.0;
    }
    const PosedPicture picture = pose_picture(scene, settings, 0);
    ShadingOptions options;
    options.brdf = GetParam() ? BrdfModel::kBurley : BrdfModel::kGltf;
    const auto environment = std::make_shared<const Environment>(Environment::sky());
    options.environment = environment;
    const ShadingScene shading(picture.frame, options);

    Random r(3);
    std::vector<Question> questions(kQuestions);
    for (int i = 0; i < kQuestions; ++i) questions[i] = random_question(r, i);
    {
        const Device::Current current(*device_);
        const gl::ShaderSource extra[] = {{"twins", kShader}};
        const Program program({{GL_COMPUTE_SHADER, "twins"}}, device_->defines(), extra);
        const gl::ShadingUpload upload(*device_, shading);
        const Buffer buffer(questions.size() * sizeof(Question), questions.data()), none(64);
        upload.set_uniforms(program, shading);
        upload.bind_points();
        none.bind(GL_SHADER_STORAGE_BUFFER, 0);
        none.bind(GL_SHADER_STORAGE_BUFFER, 7);
        buffer.bind(GL_SHADER_STORAGE_BUFFER, 1);
        program.use();
        glDispatchCompute(kQuestions / 64, 1, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        buffer.read(0, questions.size() * sizeof(Question), questions.data());
        gl::check("asking the twins");
    }

    Worst worst;
    std::int64_t textures_off = 0;
    const std::vector<PosedLight>& lights = shading.lighting().lights;
    for (int i = 0; i < kQuestions; ++i) {
        const Question& k = questions[i];
        const glm::vec3 base(k.base);
        const float cos_view = k.angles.y, cos_light = k.angles.z, cos_half = k.angles.w, cos_difference = k.more.x;
        const Brdf brdf(base, k.base.w, k.angles.x, cos_view,
                        DielectricReflection::of(k.more.y, k.more.z, {base.z, base.y, base.x}), options.brdf);
        worst.add(0, brdf.reflected(cos_light, cos_half, cos_difference),
                  Coat(k.direction.w, k.angles.x, cos_view).reflected(cos_light, cos_half, cos_difference),
                  k.answers[0]);
        worst.add(1, Sheen(base, k.more.w, cos_view).reflected(cos_light, cos_half), sheen_albedo(cos_view, k.more.w),
                  k.answers[1]);
        const glm::vec2 albedo = specular_albedo(cos_view, k.angles.x);
        const glm::vec3 direction(k.direction), position(k.position);
        worst.add(2, environment->matte(direction), albedo.x, k.answers[2]);
        worst.add(3, environment->shiny(direction, k.angles.x), albedo.y, k.answers[3]);
        const Incoming from = incoming(lights[i % lights.size()], position);
        const View& view = picture.frame.view;
        worst.add(4, from.irradiance,
                  static_cast<float>(view.lens.coc(static_cast<double>(k.footprint.w), true, view.depth_near)),
                  k.answers[4]);
        worst.add(5, from.to_light, shading.shadow_texel(position), k.answers[5]);
        const int m = static_cast<int>(k.place.z);
        const BoundMaterial& material = *shading.parts()[m].material;
        const glm::vec4 texel = (m % 2 == 0 ? material.base_color : material.occlusion)
                                    .sample({k.place.x, k.place.y}, {k.footprint.x, k.footprint.y, k.footprint.z});
        double off = Worst::off(texel.w, k.answers[6].w);
        for (int c = 0; c < 3; ++c) off = std::max(off, Worst::off(texel[c], k.answers[6][c]));
        // Where rounding decides between two texels, or how many taps there are, more than bits differ.
        if (off > 1e-4)
            ++textures_off;
        else
            worst.of[6] = std::max(worst.of[6], off);
    }
    const char* const kinds[7][2] = {{"Brdf", "Coat"},      {"Sheen", "sheen_albedo"}, {"matte", "specular_albedo.x"},
                                     {"shiny", "albedo.y"}, {"irradiance", "coc"},     {"to_light", "shadow_texel"},
                                     {"texture", ""}};
    for (int kind = 0; kind < 7; ++kind) {
        std::printf("%s %.1e, %s %.1e; ", kinds[kind][0], worst.of[kind], kinds[kind][1], worst.of_w[kind]);
        EXPECT_LT(worst.of[kind], kind == 3 ? 1e-3 : 1e-4) << kinds[kind][0];
        EXPECT_LT(worst.of_w[kind], 1e-4) << kinds[kind][1];
    }
    std::printf("textures otherwise: %lld of %d\n", static_cast<long long>(textures_off), kQuestions);
    EXPECT_LT(textures_off, kQuestions / 1000);
}

INSTANTIATE_TEST_SUITE_P(Gl, GlShadeTwins, testing::Bool());

}  // namespace
}  // namespace pentaprism
