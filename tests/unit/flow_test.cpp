// Flow against finite differences: vertices posed one by one at each time, and projected by what a frame's file says of
// its camera.
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <gtest/gtest.h>
#include <pentaprism/render.h>

#include "scene/pose.h"

namespace pentaprism {
namespace {

constexpr int kWidth = 480, kHeight = 270;

RenderSettings sharp_picture(int spp, std::vector<Aov> aovs) {
    RenderSettings settings;
    settings.image.width = kWidth;
    settings.image.height = kHeight;
    settings.image.spp = spp;
    settings.image.aovs = std::move(aovs);
    settings.shutter.shutter = 0.0;
    settings.camera.defocus = false;
    settings.method.shadows = ShadowMode::kOff;
    return settings;
}

// Pixels from the upper left corner, y down; no number behind the camera.
glm::dvec2 projected(const FrameInfo& info, const glm::dvec3& p) {
    const glm::dvec4 q = glm::make_mat4(info.world_to_ndc.data()) * glm::dvec4(p, 1.0);
    return q.w > 0.0 ? glm::dvec2((0.5 + 0.5 * q.x / q.w) * kWidth, (0.5 - 0.5 * q.y / q.w) * kHeight)
                     : glm::dvec2(std::nan(""));
}

FrameInfo info_of(const Scene& scene, double frame) {
    RenderStats stats;
    return render_picture(scene, sharp_picture(1, {}), frame, stats).info;
}

std::vector<glm::dvec3> vertices_at(const Scene& scene, double frame) {
    std::vector<glm::dvec3> all;
    const Pose pose = evaluate(scene, choose_animations(scene, "all"), frame / AnimationSettings{}.fps);
    for (const Placement& placement : placements(scene)) {
        const std::size_t count = scene.meshes[placement.mesh].primitives[placement.primitive].positions.size();
        all.resize(all.size() + count);
        pose_positions(scene, pose, placement, std::span(all).last(count));
    }
    return all;
}

struct Channels {
    const Picture& picture;
    double at(int channel, int x, int y) const {
        return picture.aovs[(static_cast<std::size_t>(channel) * kHeight + y) * kWidth + x];
    }
    glm::dvec2 two(int channel, int x, int y) const { return {at(channel, x, y), at(channel + 1, x, y)}; }
};

// Where a vertex is what its pixel sees, and flow is even about it, flow is the way of the vertex.
void expect_finite_differences(const char* name, double frame, double step) {
    const Scene scene = load_scene(name);
    RenderSettings settings = sharp_picture(16, {Aov::kMotion, Aov::kPosition});
    settings.image.flow_step = step;
    RenderStats stats;
    const Picture picture = render_picture(scene, settings, frame, stats);
    const Channels channels{picture};
    const FrameInfo before = info_of(scene, frame - step), after = info_of(scene, frame + step);
    const auto now = vertices_at(scene, frame), then = vertices_at(scene, frame + step),
               once = vertices_at(scene, frame - step);
    int compared = 0;
    double longest = 0.0;
    for (std::size_t i = 0; i < now.size(); ++i) {
        const glm::dvec2 place = projected(picture.info, now[i]);
        const int x = static_cast<int>(std::floor(place.x)), y = static_cast<int>(std::floor(place.y));
        if (!(x >= 1 && x < kWidth - 1 && y >= 1 && y < kHeight - 1)) continue;
        // A pixel's width where the vertex is, and how much flow differs from pixel to pixel there.
        const glm::dvec4 eye = glm::make_mat4(picture.info.world_to_camera.data()) * glm::dvec4(now[i], 1.0);
        const glm::dvec3 seen(channels.at(4, x, y), channels.at(5, x, y), channels.at(6, x, y));
        if (glm::length(seen - now[i]) > -eye.z / picture.info.fx) continue;
        double uneven = 0.0;
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx)
                for (const int channel : {0, 2})
                    uneven = std::max(uneven,
                                      glm::length(channels.two(channel, x + dx, y + dy) - channels.two(channel, x, y)));
        if (uneven > 0.1) continue;
        ++compared;
        const glm::dvec2 forward = projected(after, then[i]) - place, backward = projected(before, once[i]) - place;
        // What is seen may lie a pixel's width before or behind the vertex: a share 1 / fx of its distance, and of
        // flow.
        const double parallax = 1.0 / picture.info.fx;
        EXPECT_LT(glm::length(channels.two(0, x, y) - forward), uneven + glm::length(forward) * parallax + 1e-3)
            << name << " vertex " << i;
        EXPECT_LT(glm::length(channels.two(2, x, y) - backward), uneven + glm::length(backward) * parallax + 1e-3)
            << name << " vertex " << i;
        longest = std::max({longest, glm::length(forward), glm::length(backward)});
        if (testing::Test::HasFailure()) return;
    }
    EXPECT_GT(compared, 3) << name;
    EXPECT_GT(longest, 1.0) << name << " moves";
}

TEST(Flow, IsTheFiniteDifferenceOfProjectedVertices) {
    for (const char* name : {"builtin:hand", "builtin:dragonfly"}) {
        expect_finite_differences(name, 7.0, 1.0);
        expect_finite_differences(name, 7.25, 0.5);
    }
}

TEST(Flow, IsThatOfAPinholeWhereTrianglesWereCutForTheBlur) {
    const Scene scene = load_scene("builtin:cubes");
    RenderSettings settings = sharp_picture(4, {Aov::kMotion, Aov::kCoc, Aov::kCoverage});
    RenderStats whole, cut;
    const Picture expected = render_picture(scene, settings, 7.0, whole);
    settings.camera.defocus = true;
    settings.camera.lens_radius = 0.02;
    settings.camera.focus_range = {0.9, 4.0};
    const Picture picture = render_picture(scene, settings, 7.0, cut);
    ASSERT_GT(cut.triangles, whole.triangles);
    int compared = 0;
    float longest = 0.0f;
    for (std::size_t i = 0; i < std::size_t{kWidth} * kHeight; ++i) {
        const auto value = [&](const Picture& of, int channel) {
            return of.aovs[std::size_t{kWidth} * kHeight * static_cast<std::size_t>(channel) + i];
        };
        if (value(picture, 4) != 0.0f || value(picture, 5) != 1.0f || value(expected, 5) != 1.0f) continue;
        ++compared;
        for (int channel = 0; channel < 4; ++channel) {
            EXPECT_NEAR(value(picture, channel), value(expected, channel), 1e-3f) << "pixel " << i;
            longest = std::max(longest, std::abs(value(picture, channel)));
        }
        if (testing::Test::HasFailure()) return;
    }
    EXPECT_GT(compared, 5000);
    EXPECT_GT(longest, 1.0f);
}

TEST(Flow, LeadsToTheMomentThatIsAskedFor) {
    const Scene scene = load_scene("builtin:cubes");
    RenderStats stats;
    RenderSettings settings = sharp_picture(4, {Aov::kMotion});
    const auto largest = [&](double step) {
        settings.image.flow_step = step;
        float most = 0.0f;
        for (const float value : render_picture(scene, settings, 7.0, stats).aovs)
            most = std::max(most, std::abs(value));
        return most;
    };
    EXPECT_EQ(largest(0.0), 0.0f);
    EXPECT_NEAR(largest(0.25) / largest(0.5), 0.5, 0.05);
}

}  // namespace
}  // namespace pentaprism
