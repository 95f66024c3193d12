// --motion-segments auto on a real scene: the wheels of a race stay round.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>

#include "camera/view.h"
#include "frame/frame.h"
#include "scene/pose.h"

namespace pentaprism {
namespace {

constexpr int kKnots = 256;  // of a frame whose points there are the true ones

struct Corner {
    double x, y, w;  // pixels from the middle, y up
};

Corner corner_at(const Frame& frame, std::uint32_t triangle, int corner, double t) {
    const Part& part = frame.parts[frame.part_of[triangle]];
    const int segments = part.moves ? part.segments : 1;
    const int segment = std::min(static_cast<int>(t * segments), segments - 1);
    const double s = t * segments - segment;
    const MovingTriangle m = moving_triangle(frame, triangle, segment);
    const auto between = [&](const float ends[2]) { return ends[0] + s * (double{ends[1]} - ends[0]); };
    const double w = between(m.w[corner]);
    return {between(m.x[corner]) / w, between(m.y[corner]) / w, w};
}

// Largest distance in pixels of the corners of a frame's wheels from the true ones at those times, of those well before
// the camera and in the picture.
double largest_distance(const Frame& a, const Frame& b) {
    double worst = 0.0;
    for (std::uint32_t triangle = 0; triangle < a.triangle_count(); ++triangle) {
        const Part& part = a.parts[a.part_of[triangle]];
        if (a.scene->nodes[part.placement.node].name.find("wheel") == std::string::npos) continue;
        for (int corner = 0; corner < 3; ++corner)
            for (int step = 0; step <= kKnots; step += 3) {
                const Corner p = corner_at(a, triangle, corner, double(step) / kKnots),
                             q = corner_at(b, triangle, corner, double(step) / kKnots);
                if (q.w < 0.5 || std::abs(q.x) > 0.5 * a.view.width || std::abs(q.y) > 0.5 * a.view.height) continue;
                worst = std::max(worst, std::hypot(p.x - q.x, p.y - q.y));
            }
    }
    return worst;
}

TEST(RealFrame, WheelsOfTheRaceStayRoundByThemselves) {
    const char* folder = std::getenv("PENTAPRISM_SCENES");
    if (folder == nullptr) GTEST_SKIP() << "PENTAPRISM_SCENES is not set";
    const Scene scene = load_scene((std::filesystem::path(folder) / "race/race.glb").string());
    const auto clips = choose_animations(scene, "all");
    RenderSettings settings;
    settings.image.width = 1280, settings.image.height = 720;
    settings.camera.camera = "trackside";
    settings.camera.defocus = false;
    for (const double shutter : {0.5, 1.0}) {  // the wheels turn by 1.5 and by 3 radians
        settings.shutter.shutter = shutter;
        const auto frame_with = [&](int segments) {
            settings.shutter.motion_segments = segments;
            return pose_frame(scene, make_view(scene, settings, 24), clips, settings.shutter);
        };
        const Frame fine = frame_with(kKnots), by_itself = frame_with(0), coarse = frame_with(2);
        ASSERT_EQ(fine.triangle_count(), by_itself.triangle_count());
        EXPECT_LT(largest_distance(by_itself, fine), 0.1);
        EXPECT_GT(largest_distance(coarse, fine), 1.0) << "two segments are too few: the test can see that";
    }
}

}  // namespace
}  // namespace pentaprism
