// The GLSL twins of bounds, culling tests and the exact test answer as the C++ functions do, question by question, on
// the triangles that are hard for them (support/hard_triangles.h).

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>
#include <pentaprism/error.h>

#include "bound/facing.h"
#include "bound/screen_bounds.h"
#include "gl/culling.h"
#include "gl/device.h"
#include "gl/program.h"
#include "support/ask_cull.h"

namespace pentaprism {
namespace {

using gl::Buffer;
using gl::Device;
using gl::Program;
using support::Hard;
using support::HardCase;
using support::Random;

constexpr int kBatch = 64;

// As the shader reads it (std430).
struct Question {
    float q[3][4], r[3][4];  // x, y, w, c of each corner at both ends
    float centre[2], segments, segment;
    float hx, hy, u, v;
    float t, two_sided, unused[2];
    float footprint[4];  // x0, x1, y0, y1
    float u0, u1, v0, v1;
    float t0, t1, more_unused[2];
};
struct Answer {
    std::uint32_t keeps;  // bit k: test k of the list
    std::uint32_t hit;
    float depth;
    std::int32_t facing;
    float barycentrics[4];
    float qx[4], qy[4], dx[4], dy[4];
    std::int32_t pixels[4];
};

std::string twin_shader(const std::vector<std::string>& tests) {
    std::string text = R"(
#include "cover/exact.glsl"
#include "bound/facing.glsl"
#include "bound/screen_bounds.glsl"
)";
    for (const std::string& name : tests) text += "#include \"cull/" + gl::stem_of(name) + ".glsl\"\n";
    text += R"(
layout(local_size_x = 64) in;
struct Question {
    vec4 q[3], r[3], place, sampled, more, footprint, lens, time;
};
struct Answer {
    uint keeps, hit;
    float depth;
    int facing;
    vec4 barycentrics, qx, qy, dx, dy;
    ivec4 pixels;
};
layout(std430, binding = 0) readonly buffer Questions { Question questions[]; };
layout(std430, binding = 1) writeonly buffer Answers { Answer answers[]; };

void main() {
    Question k = questions[gl_GlobalInvocationID.x];
    MovingTriangle m = MovingTriangle(k.q, k.r, vec3(k.q[0].z, k.q[1].z, k.q[2].z), vec3(k.r[0].z, k.r[1].z, k.r[2].z));
    ScreenBox bounds = screen_bounds(m);
    LocalTriangle T = localize(m, exact_box(m, bounds), k.place.xy, k.place.z, k.place.w, k.more.y != 0.0);
    LocalSample s = LocalSample(k.sampled.x, k.sampled.y, k.sampled.z, k.sampled.w, k.more.x);
    Footprint f = Footprint(k.footprint.x, k.footprint.y, k.footprint.z, k.footprint.w,
                            Domain(k.lens.x, k.lens.y, k.lens.z, k.lens.w, k.time.x, k.time.y));
    SampleHit hit = cover_sample(T, s, k.place.xy);
    Answer a;
    a.keeps = 0u;
)";
    for (std::size_t i = 0; i < tests.size(); ++i)
        text += fmt::format("    if ({}_keeps(T, f, s)) a.keeps |= 1u << {};\n", gl::stem_of(tests[i]), i);
    return text + R"(
    a.hit = hit.hit ? hit.front ? 2u : 1u : 0u;
    a.depth = hit.depth;
    a.facing = facing(m);
    a.barycentrics = vec4(hit.barycentrics, 0.0);
    a.qx = vec4(T.qx, 0.0), a.qy = vec4(T.qy, 0.0), a.dx = vec4(T.dx, 0.0), a.dy = vec4(T.dy, 0.0);
    a.pixels = covered_pixels(bounds, ivec4(0, picture_width, 0, picture_height));
    answers[gl_GlobalInvocationID.x] = a;
}
)";
}

Question question_of(const HardCase& c, const Footprint& f, const LocalSample& s) {
    Question k{};
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end) {
            float* const to = end == 0 ? k.q[i] : k.r[i];
            to[0] = c.moving.x[i][end], to[1] = c.moving.y[i][end], to[2] = c.moving.w[i][end];
            to[3] = c.moving.c[i][end];
        }
    k.centre[0] = c.centre.x, k.centre[1] = c.centre.y, k.segments = c.local.segments, k.segment = c.local.segment;
    k.hx = s.hx, k.hy = s.hy, k.u = s.u, k.v = s.v, k.t = s.t;
    k.two_sided = c.local.two_sided ? 1.0f : 0.0f;
    k.footprint[0] = f.x0, k.footprint[1] = f.x1, k.footprint[2] = f.y0, k.footprint[3] = f.y1;
    k.u0 = f.domain.u0, k.u1 = f.domain.u1, k.v0 = f.domain.v0, k.v1 = f.domain.v1;
    k.t0 = f.domain.t0, k.t1 = f.domain.t1;
    return k;
}

LocalSample random_sample(Random& r, const HardCase& c) {
    const auto place = [&] { return static_cast<float>(std::floor(r.range(-16, 16) * 256) / 256); };
    const double t = (r.unit() + c.local.segment) / c.local.segments;
    const double across = std::sqrt(r.unit()), angle = r.range(0, 2 * std::numbers::pi);
    return {place(), place(), static_cast<float>(across * std::cos(angle)),
            static_cast<float>(across * std::sin(angle)) * c.ratio(),
            static_cast<float>(std::floor(t * 0x1p24) * 0x1p-24)};
}

// Half aimed at the triangle, some of them moved to where the exact test changes its mind.
LocalSample any_sample(Random& r, Hard hard, const HardCase& c) {
    LocalSample s;
    SampleHit hit;
    if (r.chance(0.5) || !support::aim(r, c, hard, support::LensShape::kDisk, s, hit)) return random_sample(r, c);
    if (r.chance(0.3)) support::push_to_border(r, c, support::LensShape::kDisk, s, hit);
    return s;
}

struct Tally {
    std::int64_t asked = 0, hits = 0, other_hit = 0, other_depth = 0, other_barycentrics = 0, other_shear = 0,
                 other_facing = 0, other_pixels = 0, lost = 0;
    std::vector<std::int64_t> kept, other;  // by test
};

class GlTwins : public testing::Test {
  protected:
    void SetUp() override {
        try {
            device_ = &Device::get();
        } catch (const Error& error) {
            GTEST_SKIP() << error.what();
        }
    }

    void ask(const Program& program, const HardCase& c, const std::vector<Question>& questions,
             std::vector<Answer>& answers) {
        const View& view = c.frame.view;
        program.set("w_near", view.w_near());
        program.set("lens_ratio", view.lens.ratio);
        program.set("z_near", static_cast<float>(view.depth_near));
        program.set("z_far", static_cast<float>(view.depth_far));
        program.set("picture_width", view.width);
        program.set("picture_height", view.height);
        const Buffer in(questions.size() * sizeof(Question), questions.data()), out(answers.size() * sizeof(Answer));
        in.bind(GL_SHADER_STORAGE_BUFFER, 0);
        out.bind(GL_SHADER_STORAGE_BUFFER, 1);
        program.use();
        glDispatchCompute(1, 1, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        out.read(0, answers.size() * sizeof(Answer), answers.data());
    }

    Device* device_ = nullptr;
};

bool same_bits(float a, float b) {
    return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

void compare_geometry(const HardCase& c, const Answer& a, Tally& tally) {
    bool same = true;
    for (int i = 0; i < 3; ++i)
        same = same && same_bits(a.qx[i], c.local.qx[i]) && same_bits(a.qy[i], c.local.qy[i]) &&
               same_bits(a.dx[i], c.local.dx[i]) && same_bits(a.dy[i], c.local.dy[i]);
    tally.other_shear += !same;
    tally.other_facing += a.facing != static_cast<int>(facing(c.moving, c.frame.view.lens.ratio));
    const View& view = c.frame.view;
    const PixelRect rect = covered_pixels(screen_bounds(c.moving, view.w_near(), view.lens.ratio), view.width,
                                          view.height, {0, view.width, 0, view.height});
    tally.other_pixels +=
        a.pixels[0] != rect.x0 || a.pixels[1] != rect.x1 || a.pixels[2] != rect.y0 || a.pixels[3] != rect.y1;
}

void compare_hit(const HardCase& c, const LocalSample& s, const Answer& a, Tally& tally) {
    const SampleHit hit = cover_sample(c.local, s, c.centre);
    tally.hits += hit.hit;
    tally.other_hit += a.hit != (hit.hit ? hit.front ? 2u : 1u : 0u);
    if (!hit.hit || a.hit == 0) return;
    tally.other_depth += !same_bits(a.depth, hit.depth);
    for (int k = 0; k < 3; ++k) tally.other_barycentrics += !same_bits(a.barycentrics[k], hit.barycentrics[k]);
}

TEST_F(GlTwins, AnswerAsTheFunctionsOfTheProcessor) {
    const std::vector<std::string> names = gl::culling_names();
    ASSERT_GE(names.size(), 7u);
    const Device::Current current(*device_);
    const std::string shader = twin_shader(names);
    const gl::ShaderSource extra[] = {{"twins", shader}};
    const Program program({{GL_COMPUTE_SHADER, "twins"}}, device_->defines(), extra);

    Tally tally;
    tally.kept.resize(names.size());
    tally.other.resize(names.size());
    for (const Hard hard : support::kHardClasses) {
        Random r(77 + static_cast<std::uint64_t>(hard));
        HardCase c;
        for (int n = 0; n < 150 * support::effort(); ++n) {
            support::make_hard_case(r, hard, c, r.chance(0.7));
            std::vector<Question> questions;
            std::vector<Answer> answers(kBatch);
            std::vector<LocalSample> samples;
            std::vector<Footprint> footprints;
            for (int i = 0; i < kBatch; ++i) {
                samples.push_back(any_sample(r, hard, c));
                footprints.push_back(region_around(r, support::kRegions[r.below(4)], c.ratio(), samples[i]));
                questions.push_back(question_of(c, footprints[i], samples[i]));
            }
            ask(program, c, questions, answers);
            compare_geometry(c, answers[0], tally);
            for (std::size_t k = 0; k < names.size(); ++k) {
                support::Asked asked(*find_cull_test(names[k]));
                for (int i = 0; i < kBatch; ++i) {
                    const bool keeps = asked.keeps(c, footprints[i], samples[i]), twin = answers[i].keeps >> k & 1;
                    tally.kept[k] += keeps;
                    tally.other[k] += keeps != twin;
                    tally.lost += !twin && answers[i].hit != 0;
                }
            }
            for (int i = 0; i < kBatch; ++i) compare_hit(c, samples[i], answers[i], tally);
            tally.asked += kBatch;
        }
    }
    gl::check("asking the twins");
    std::printf("%lld questions, %lld hits\n", static_cast<long long>(tally.asked), static_cast<long long>(tally.hits));
    EXPECT_GT(tally.hits, tally.asked / 10);
    EXPECT_EQ(tally.other_hit, 0);
    EXPECT_EQ(tally.other_depth, 0);
    EXPECT_EQ(tally.other_barycentrics, 0);
    EXPECT_EQ(tally.other_shear, 0);
    EXPECT_EQ(tally.other_facing, 0);
    EXPECT_EQ(tally.other_pixels, 0);
    EXPECT_EQ(tally.lost, 0) << "a test refuses what the exact test accepts";
    for (std::size_t k = 0; k < names.size(); ++k) {
        EXPECT_EQ(tally.other[k], 0) << names[k] << " of " << tally.asked;
        EXPECT_GT(tally.kept[k], 0);
        if (names[k] != "none" && names[k] != "bbox") {
            EXPECT_LT(tally.kept[k], tally.asked) << names[k];
        }
    }
}

}  // namespace
}  // namespace pentaprism
