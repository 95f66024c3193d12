// Visibility by tracing rays: the same samples see the same triangles as stochastic rasterization finds, but for those
// on edges; and the answer depends on nothing but the frame.
#include <algorithm>
#include <cstdio>
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "peer/posed_picture.h"
#include "render/visibility.h"
#include "support/random_frame.h"

namespace pentaprism {
namespace {

struct Found {
    std::vector<std::uint32_t> triangles;
    std::vector<float> depths;
};

Found find(const Frame& frame, const SampleTable& table, VisibilityMethod visibility, int tile_size = 32) {
    MethodSettings method;
    method.visibility = visibility;
    method.tile_size = tile_size;
    const Visibility door(frame, table, method, {0, frame.view.width, 0, frame.view.height});
    Found found;
    Hits hits;
    CoverCounts counts;
    const std::size_t n = static_cast<std::size_t>(frame.view.width) * frame.view.height * table.spp();
    found.triangles.resize(n);
    found.depths.resize(n);
    for (const Tile& tile : door.tiles()) {
        door.cover(tile, hits, counts);
        for (int py = tile.y0; py < tile.y1; ++py)
            for (int px = tile.x0; px < tile.x1; ++px)
                for (int index = 0; index < table.spp(); ++index) {
                    const int block = py % kCellSize / kBlockSize * kCellBlocks + px % kCellSize / kBlockSize;
                    const int lane = py % kBlockSize * kBlockSize + px % kBlockSize;
                    const std::size_t from =
                        (static_cast<std::size_t>(block) * table.slots() + table.slot_of(px, py, index)) * kLanes +
                        lane;
                    const std::size_t to = (static_cast<std::size_t>(py) * frame.view.width + px) * table.spp() + index;
                    found.triangles[to] = hits.triangle[from];
                    found.depths[to] = hits.depth[from];
                }
    }
    return found;
}

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
        const Found ours = find(picture.frame, picture.samples, VisibilityMethod::kStochastic);
        const Found traced = find(picture.frame, picture.samples, VisibilityMethod::kRaytrace);
        int different = 0, hit = 0;
        for (std::size_t i = 0; i < ours.triangles.size(); ++i) {
            different += ours.triangles[i] != traced.triangles[i];
            hit += ours.triangles[i] != kNoTriangle;
        }
        std::printf("  %s: %d of %zu samples differ, %d hit\n", c.scene, different, ours.triangles.size(), hit);
        EXPECT_LE(different, c.most) << c.scene;
        EXPECT_GT(hit, 20000) << c.scene;
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
    const Found one = find(frame, table, VisibilityMethod::kRaytrace);
    for (const int threads : {2, 3, 8})
        for (const int tile_size : {8, 32}) {
            set_thread_count(threads);
            const Found many = find(frame, table, VisibilityMethod::kRaytrace, tile_size);
            EXPECT_EQ(many.triangles, one.triangles) << threads << " threads, tiles of " << tile_size;
            EXPECT_EQ(many.depths, one.depths) << threads << " threads, tiles of " << tile_size;
        }
}

}  // namespace
}  // namespace pentaprism
