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
#ifdef PENTAPRISM_HAVE_EMBREE
#include "trace/embree_tracer.h"
#endif

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
    const auto corners = frame.corners;
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

#ifdef PENTAPRISM_HAVE_EMBREE
Found trace_with(const PosedPicture& picture, const EmbreeOptions& options, bool refit = false) {
    EmbreeTracer tracer(picture.frame, picture.samples, options);
    if (refit) tracer.refit();
    Found found;
    Hits hits;
    const View& view = picture.frame.view;
    for (const Tile& tile : tiles_over({0, view.width, 0, view.height}, kCellSize)) {
        hits.reset(picture.samples.slots(), tile);
        tracer.trace(tile, hits);
        found.triangles.insert(found.triangles.end(), hits.triangle.begin(), hits.triangle.end());
        found.depths.insert(found.depths.end(), hits.depth.begin(), hits.depth.end());
    }
    return found;
}

TEST_F(Raytrace, SeesTheSameHoweverEmbreeIsSetUpForSpeed) {
    // What is timed against must do the work: each configuration, cut-out leaves and moving parts among them, but for
    // samples on edges. Sizes that are no multiple of a block leave some rays out.
    for (const char* name : {"builtin:hand", "builtin:fairy-forest"}) {
        const Scene scene = load_scene(name);
        RenderSettings settings;
        settings.image.width = 150;
        settings.image.height = 90;
        settings.image.spp = 4;
        settings.shutter.shutter = 1.0;
        const PosedPicture picture = pose_picture(scene, settings, 24);
        EmbreeOptions speed;
        speed.for_speed = true;
        const Found usual = trace_with(picture, speed);
        EXPECT_GT(usual.hits(), 10000);
        const auto same = [&](const EmbreeOptions& options, const char* what, bool refit = false) {
            const int different = trace_with(picture, options, refit).count_other_triangles(usual);
            EXPECT_LE(different, static_cast<int>(usual.triangles.size() / 2000)) << name << ", " << what;
        };
        for (const EmbreeRays rays : {EmbreeRays::kPacket8, EmbreeRays::kPacket4, EmbreeRays::kSingle,
                                      EmbreeRays::kStream, EmbreeRays::kPacketStream16}) {
            EmbreeOptions options = speed;
            options.rays = rays;
            same(options, "rays");
        }
        for (const EmbreeLayout layout : {EmbreeLayout::kTogether, EmbreeLayout::kParts}) {
            EmbreeOptions options = speed;
            options.layout = layout;
            same(options, "layout");
        }
        for (const EmbreeBuild build : {EmbreeBuild::kLow, EmbreeBuild::kHigh}) {
            EmbreeOptions options = speed;
            options.build = build;
            same(options, "build");
        }
        EmbreeOptions other = speed;
        other.device = "tri_accel_mb=bvh8.triangle4vmb,tri_accel=bvh8.triangle4v";
        other.coherent = false;
        other.robust_speed = true;
        same(other, "hierarchy");
        other = speed;
        other.dynamic = true;
        same(other, "refit", true);
    }
}
#endif

}  // namespace
}  // namespace pentaprism
