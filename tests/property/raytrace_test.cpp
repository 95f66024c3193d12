// Visibility by tracing rays: the same samples see the same triangles as stochastic rasterization finds, but for those
// on edges; and the answer depends on nothing but the frame.
#include <algorithm>
#include <cstdio>
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "peer/posed_picture.h"
#include "render/visibility.h"
#include "support/found.h"
#include "support/random_frame.h"

namespace pentaprism {
namespace {

using support::find_visible;
using support::Found;

class Raytrace : public ::testing::Test {
  protected:
    void SetUp() override {
        if (tracer_name().empty()) GTEST_SKIP() << "this build has no Embree";
    }
    void TearDown() override { set_thread_count(0); }
};

TEST_F(Raytrace, SeesWhatStochasticRasterizationSeesOnBuiltInScenes) {
    struct Case {
        const char* scene;
        double fstop;
        int most;  // samples that may differ, of 230400 or so
    };
    for (const Case& c :
         {Case{"builtin:cubes", 2.0, 2}, Case{"builtin:hand", 2.0, 8}, Case{"builtin:dragonfly", 1.4, 24}}) {
        const Scene scene = load_scene(c.scene);
        RenderSettings settings;
        settings.image.width = 160;
        settings.image.height = 90;
        settings.camera.fstop = c.fstop;
        settings.shutter.shutter = 1.0;
        const PosedPicture picture = pose_picture(scene, settings, 12);
        const Found ours = find_visible(picture.frame, picture.samples, VisibilityMethod::kStochastic);
        const Found traced = find_visible(picture.frame, picture.samples, VisibilityMethod::kRaytrace);
        const int different = traced.count_other_triangles(ours);
        std::printf("  %s: %d of %zu samples differ\n", c.scene, different, ours.triangles.size());
        EXPECT_LE(different, c.most) << c.scene;
        EXPECT_GT(ours.hits(), 20000) << c.scene;
    }
}

TEST_F(Raytrace, DoesNotDependOnThreadsTilesOrTheBuild) {
    // Hubs and edges that many triangles share, on the lattice of samples: ties in depth are everywhere.
    testing::RandomFrame wanted;
    wanted.width = wanted.height = 64;
    wanted.triangles = 3000;
    wanted.size = 0.3;
    Frame frame = testing::make_random_frame(wanted, 5);
    // Each triangle twice more, under other numbers: each hit is a tie of three.
    Part& part = frame.parts[0];
    const std::vector<std::uint32_t> corners = frame.corners;
    for (int copy = 0; copy < 2; ++copy) frame.corners.insert(frame.corners.end(), corners.begin(), corners.end());
    part.triangle_count *= 3;
    frame.part_of.assign(part.triangle_count, 0);
    const SampleTable table(4, 1, frame.view.lens, grouping_for(frame));
    set_thread_count(1);
    const Found one = find_visible(frame, table, VisibilityMethod::kRaytrace);
    for (const int threads : {2, 3, 8})
        for (const int tile_size : {8, 32}) {
            set_thread_count(threads);
            const Found many = find_visible(frame, table, VisibilityMethod::kRaytrace, tile_size);
            EXPECT_TRUE(many == one) << threads << " threads, tiles of " << tile_size;
        }
}

}  // namespace
}  // namespace pentaprism
