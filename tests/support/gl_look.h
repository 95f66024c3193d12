#pragma once
// Whole frames as the processor and OpenGL see them, compared sample by sample.

#include <algorithm>
#include <bit>
#include <gtest/gtest.h>
#include <pentaprism/error.h>
#include <pentaprism/settings.h>
#include <string>
#include <vector>

#include "gl/device.h"
#include "peer/posed_picture.h"
#include "render/visibility.h"
#include "support/isa.h"

namespace pentaprism::support {

inline constexpr int kWidth = 96, kHeight = 72, kSpp = 6;  // six: the last pass is not full

inline RenderSettings settings_of(int width = kWidth, int height = kHeight, int spp = kSpp) {
    RenderSettings settings;
    settings.image.width = width;
    settings.image.height = height;
    settings.image.spp = spp;
    return settings;
}

struct Seen {
    std::vector<std::uint32_t> triangle, depth;  // tile by tile, as in Hits; bits of the depth
    CoverCounts counts;
    CoverMap map;
    std::string pipeline;
};

enum class By { kCpu, kGeometry, kCompute, kAuto };

inline Seen look(const PosedPicture& picture, By by, const std::string& culling, int tile_size = kCellSize) {
    MethodSettings method;
    method.backend = by == By::kCpu ? Backend::kCpu : Backend::kGl;
    method.gl_pipeline = by == By::kGeometry  ? GlPipeline::kGeometry
                         : by == By::kCompute ? GlPipeline::kCompute
                                              : GlPipeline::kAuto;
    method.culling = culling;
    method.tile_size = tile_size;
    const View& view = picture.frame.view;
    const Visibility visibility(picture.frame, picture.samples, method, {0, view.width, 0, view.height});
    Seen seen;
    seen.pipeline = visibility.gl_pipeline();
    seen.map.width = view.width;
    seen.map.height = view.height;
    seen.map.tested.resize(static_cast<std::size_t>(view.width) * view.height);
    seen.map.covered.resize(seen.map.tested.size());
    Hits hits;
    for (const Tile& tile : visibility.tiles()) {
        visibility.cover(tile, hits, seen.counts, &seen.map);
        seen.triangle.insert(seen.triangle.end(), hits.triangle.begin(), hits.triangle.end());
        for (const float depth : hits.depth) seen.depth.push_back(std::bit_cast<std::uint32_t>(depth));
    }
    return seen;
}

inline std::int64_t differing(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
    EXPECT_EQ(a.size(), b.size());
    std::int64_t n = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) n += a[i] != b[i];
    return n;
}

class GlBackend : public testing::Test {
  protected:
    void SetUp() override {
        try {
            gl::Device::get();
        } catch (const Error& error) {
            GTEST_SKIP() << error.what();
        }
    }
};

// Counts are those of boxes in double, as one processor target makes them; the others' boxes in float are a little
// wider.
inline void expect_same(const Scene& scene, const RenderSettings& settings, double frame, const std::string& culling) {
    const UseIsa scalar("scalar");
    const PosedPicture picture = pose_picture(scene, settings, frame);
    const Seen cpu = look(picture, By::kCpu, culling);
    EXPECT_GT(cpu.counts.covered, 0) << scene.name;
    for (const By by : {By::kGeometry, By::kCompute}) {
        SCOPED_TRACE(by == By::kGeometry ? "geometry" : "compute");
        const Seen gl = look(picture, by, culling);
        const std::int64_t triangles = differing(cpu.triangle, gl.triangle), depths = differing(cpu.depth, gl.depth);
        const double per_million = 1e6 / static_cast<double>(cpu.triangle.size());
        EXPECT_EQ(triangles, 0) << scene.name << ": " << static_cast<double>(triangles) * per_million << " per million";
        EXPECT_EQ(depths, 0) << scene.name << ": " << static_cast<double>(depths) * per_million << " per million";
        EXPECT_EQ(cpu.counts.tested, gl.counts.tested) << scene.name << ", " << culling;
        EXPECT_EQ(cpu.counts.covered, gl.counts.covered) << scene.name << ", " << culling;
        EXPECT_EQ(cpu.map.tested, gl.map.tested);
        EXPECT_EQ(cpu.map.covered, gl.map.covered);
    }
}

}  // namespace pentaprism::support
