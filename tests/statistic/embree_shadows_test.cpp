// Shadow maps against rays: of the points that a picture shows, how many lie in a shadow that no ray finds (a surface
// shadows itself), and how many in light that rays do not find (it leaks). Nothing moves; pixels at edges of shadows
// are left out, as the map filters them.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <embree3/rtcore.h>
#include <filesystem>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "frame/opacity.h"
#include "peer/posed_picture.h"
#include "sample/net.h"
#include "shade/light_point.h"
#include "shade/shaded_triangle.h"
#include "support/found.h"

namespace pentaprism {
namespace {

// The frame's triangles as they are at mid-shutter, relative to the eye.
class Rays {
  public:
    Rays(const Frame& frame, const glm::dvec3& eye) : frame_(frame) {
        const WorldMotion world = world_motion(frame, eye, true);
        device_ = rtcNewDevice("threads=2");
        scene_ = rtcNewScene(device_);
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        void* points = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                               sizeof(glm::vec3), world.points.size());
        std::copy(world.points.begin(), world.points.end(), static_cast<glm::vec3*>(points));
        void* corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                3 * sizeof(std::uint32_t), frame.triangle_count());
        for (std::uint32_t triangle = 0; triangle < frame.triangle_count(); ++triangle)
            std::ranges::copy(world.corners(triangle),
                              static_cast<std::uint32_t*>(corners) + 3 * std::size_t{triangle});
        rtcSetGeometryUserData(geometry, this);
        rtcSetGeometryOccludedFilterFunction(geometry, filter);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }
    ~Rays() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    Rays(const Rays&) = delete;
    Rays& operator=(const Rays&) = delete;

    bool is_lit(const glm::vec3& from, const glm::vec3& way, float length, std::uint32_t own) const {
        Context context;
        rtcInitIntersectContext(&context);
        context.own = own;
        RTCRay ray{};
        ray.org_x = from.x, ray.org_y = from.y, ray.org_z = from.z;
        ray.dir_x = way.x, ray.dir_y = way.y, ray.dir_z = way.z;
        ray.tnear = 0.0f, ray.tfar = length, ray.mask = 0xffffffffu;
        rtcOccluded1(scene_, &context, &ray);
        return ray.tfar >= 0.0f;
    }

  private:
    struct Context : RTCIntersectContext {
        std::uint32_t own;
    };
    static void filter(const RTCFilterFunctionNArguments* arguments) {
        const Rays& rays = *static_cast<const Rays*>(arguments->geometryUserPtr);
        const std::uint32_t triangle = RTCHitN_primID(arguments->hit, 1, 0);
        const float u = RTCHitN_u(arguments->hit, 1, 0), v = RTCHitN_v(arguments->hit, 1, 0);
        const float b[3] = {1.0f - u - v, u, v};
        if (triangle == static_cast<const Context*>(arguments->context)->own ||
            !is_opaque_at(rays.frame_, triangle, b, 0, 0, 0, OpacityPattern(1, 0)))
            arguments->valid[0] = 0;
    }

    const Frame& frame_;
    RTCDevice device_;
    RTCScene scene_;
};

struct Counts {
    std::int64_t light = 0, shadow = 0;  // pixels in the middle of light, of shadow
    double dark = 0.0, leak = 0.0;       // wrong there, sums of shares
    double dark_share() const { return dark / static_cast<double>(std::max<std::int64_t>(light, 1)); }
    double leak_share() const { return leak / static_cast<double>(std::max<std::int64_t>(shadow, 1)); }
};

// Of one light, at every pixel: whether rays and how much of the map's samples find it; -1: not asked.
struct Compared {
    std::vector<float> exact, map;
};

Counts count(const Compared& pixels, int width, int height) {
    Counts counts;
    for (int y = 1; y + 1 < height; ++y)
        for (int x = 1; x + 1 < width; ++x) {
            const std::size_t at = static_cast<std::size_t>(y) * width + x;
            const float exact = pixels.exact[at];
            bool same = exact >= 0.0f;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const float other = pixels.exact[at + dy * width + dx];
                    same = same && (other == exact || other < 0.0f);
                }
            if (!same) continue;
            if (exact > 0.0f) {
                ++counts.light;
                counts.dark += 1.0 - pixels.map[at];
            } else {
                ++counts.shadow;
                counts.leak += pixels.map[at];
            }
        }
    return counts;
}

struct Case {
    std::string scene;
    int frame, width, height;
    const char* camera;
};

Counts compare(const Case& c) {
    const Scene scene = load_scene(c.scene);
    RenderSettings settings;
    settings.image.width = c.width;
    settings.image.height = c.height;
    settings.image.spp = 1;
    settings.camera.camera = c.camera;
    settings.camera.defocus = false;
    settings.shutter.motion_blur = false;
    const PosedPicture picture = pose_picture(scene, settings, c.frame);
    const Frame& frame = picture.frame;
    const support::Found found = support::find_visible(frame, picture.samples, VisibilityMethod::kStochastic);
    ShadingOptions options;
    options.rate = ShadingRate::kDecoupled;  // for places on triangles
    const ShadingScene shading(frame, options);
    const Rays rays(frame, glm::dvec3(glm::inverse(world_to_camera(frame.view, frame.middle))[3]));
    const Lighting& lighting = shading.lighting();
    std::vector<Compared> lights(lighting.lights.size());
    for (Compared& light : lights) {
        light.exact.assign(found.triangles.size(), -1.0f);
        light.map.assign(found.triangles.size(), 0.0f);
    }
    parallel_for(static_cast<std::size_t>(c.height), [&](std::size_t y) {
        LitColor lit;
        ShadowsOnTriangle shadows;
        for (int x = 0; x < c.width; ++x) {
            const std::size_t at = y * c.width + x;
            const std::uint32_t triangle = found.triangles[at];
            if (triangle == kNoTriangle) continue;
            const ShadedTriangle shaded(shading, triangle, 1.0f);
            const glm::vec3 b = shaded.barycentrics_at({x + 0.5 - 0.5 * c.width, 0.5 * c.height - 0.5 - y});
            const ShadedPart& part = shading.part_of(triangle);
            glm::vec3 corner[3], position(0.0f);
            for (int k = 0; k < 3; ++k) {
                corner[k] = part.positions[frame.vertices(triangle)[k]];
                position += b[k] * corner[k];
            }
            glm::vec3 face = glm::normalize(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
            const bool front = glm::dot(face, shading.to_eye(position)) >= 0.0f;
            if (!front) face = -face;
            light_point(shading, shaded.material(), shaded.surface(b, front, ShadingCell{}), lit);
            shadows.start(shading.shadows(), triangle);
            ShadowPoint point;
            for (int k = 0; k < 3; ++k) std::fill_n(point.barycentrics[k], ShadowPoint::kLanes, b[k]);
            point.quarters = 0xf;
            point.position = lit.position;
            point.texel = shading.shadow_texel(lit.position);
            for (const LitColor::Share& share : lit.shadowed) {
                const PosedLight& light = lighting.lights[share.light];
                const glm::vec3 to_light = incoming(light, lit.position).to_light;
                if (glm::dot(face, to_light) <= 0.0f) continue;  // rays know nothing of the smooth surface
                const glm::vec3 from = lit.position + share.offset;
                const float length =
                    light.kind == LightKind::kDirectional ? INFINITY : glm::length(light.position - from);
                lights[share.light].exact[at] = rays.is_lit(from, to_light, length, triangle) ? 1.0f : 0.0f;
                point.offset = share.offset;
                lights[share.light].map[at] = std::popcount(shadows.lit(share.light, point, mix(at))) / 16.0f;
            }
        }
    });
    Counts all;
    for (const Compared& light : lights) {
        const Counts counts = count(light, c.width, c.height);
        all.light += counts.light, all.shadow += counts.shadow;
        all.dark += counts.dark, all.leak += counts.leak;
    }
    std::printf("  %-24s frame %2d: in light %7lld, dark %.5f; in shadow %7lld, lit %.5f\n",
                std::filesystem::path(c.scene).stem().c_str(), c.frame, static_cast<long long>(all.light),
                all.dark_share(), static_cast<long long>(all.shadow), all.leak_share());
    return all;
}

// `dark` and `lit`: the most that may be wrong in light and in shadow. What is left is mostly not wrong: the map's
// filter reaches over thin shadows and lights which no neighbouring pixel shows.
struct Expected {
    Case what;
    double dark, lit;
};

void expect(const std::vector<Expected>& all) {
    for (const Expected& expected : all) {
        const Counts counts = compare(expected.what);
        const std::string name = expected.what.scene + " " + expected.what.camera;
        EXPECT_GT(counts.light, 5000) << name;
        EXPECT_GT(counts.shadow, 1500) << name;
        EXPECT_LE(counts.dark_share(), expected.dark) << name;
        EXPECT_LE(counts.leak_share(), expected.lit) << name;
    }
}

TEST(ShadowsAgainstRays, BuiltInScenes) {
    expect({{{"builtin:fairy-forest", 24, 640, 360, ""}, 0.009, 0.034},
            {{"builtin:hand", 24, 640, 360, ""}, 0.0009, 0.003},
            {{"builtin:conan", 24, 640, 360, ""}, 0.0032, 0.0125}});
}

TEST(ShadowsAgainstRays, SharedScenes) {
    const char* folder = std::getenv("PENTAPRISM_SCENES");
    if (folder == nullptr) GTEST_SKIP() << "PENTAPRISM_SCENES is not set";
    const std::string at = std::string(folder) + "/";
    const std::string lamp = at + "khronos/LightsPunctualLamp/LightsPunctualLamp.gltf";
    expect({{{at + "hand/hand.glb", 12, 640, 480, ""}, 0.002, 0.004},
            {{at + "hand/hand.glb", 24, 640, 480, "close"}, 0.0007, 0.012},
            {{at + "race/race.glb", 24, 640, 360, "chase"}, 0.0008, 0.0032},
            {{at + "torcs/torcs-race.glb", 24, 640, 360, "chase"}, 0.0009, 0.0105},
            {{at + "environment/apartment.glb", 12, 640, 360, "flyover"}, 0.0002, 0.0055},
            {{at + "environment/apartment.glb", 12, 640, 360, "inside"}, 0.0003, 0.0027},
            {{at + "environment/apartment.glb", 0, 640, 360, "inside"}, 0.0001, 0.0012},
            {{at + "insects/insects.glb", 24, 640, 360, "macro"}, 0.0007, 0.0025},
            {{at + "forest/forest.glb", 24, 640, 360, "dolly"}, 0.0026, 0.0019},
            {{lamp, 0, 640, 360, ""}, 0.021, 0.017}});  // a point light
}

}  // namespace
}  // namespace pentaprism
