#include "shade/shadow_raster.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

#include "base/aligned.h"
#include "cover/exact.h"
#include "support/isa.h"
#include "support/random.h"

namespace pentaprism {
namespace {

constexpr int kWidth = 64;       // texels of the level: four cells
constexpr float kScale = 32.0f;  // texels a unit

// Triangles of all sizes before a light at the origin that looks along z; half of them move, in one or three pieces.
struct World {
    WorldMotion motion;
    Frame frame;  // all of it is solid

    World() { motion.frame = &frame; }
    World(const World&) = delete;
    World& operator=(const World&) = delete;
    void add_part(const Part& part) {
        motion.parts.push_back(part);
        motion.shifts.push_back(0);
        motion.bounds.push_back({glm::vec3(-100.0f), glm::vec3(100.0f)});
        frame.parts = motion.parts;
    }
};

void fill(World& world, support::Random& random) {
    const auto part_of = [&](int segments, bool moves) {
        Part part;
        part.first_triangle = static_cast<std::uint32_t>(world.frame.part_of.size());
        part.triangle_count = 60;
        part.first_point = static_cast<std::uint32_t>(world.motion.points.size());
        part.vertex_count = 3 * part.triangle_count;
        part.segments = segments;
        part.moves = moves;
        std::vector<glm::vec3> points;
        for (std::uint32_t t = 0; t < part.triangle_count; ++t) {
            const double size = std::exp2(random.range(-6.0, 0.5));
            const glm::dvec3 middle(random.range(-1.1, 1.1), random.range(-1.1, 1.1), random.range(0.8, 5.0));
            for (int k = 0; k < 3; ++k) {
                const glm::dvec3 p(middle.x + size * random.range(-1.0, 1.0), middle.y + size * random.range(-1.0, 1.0),
                                   1.0 + 0.2 * random.range(-1.0, 1.0));
                points.emplace_back(p.x * middle.z, p.y * middle.z, p.z * middle.z);
            }
            world.frame.part_of.push_back(static_cast<std::uint32_t>(world.frame.parts.size()));
        }
        for (std::uint32_t i = 0; i < part.vertex_count; ++i) world.frame.corners.push_back(part.first_point + i);
        for (int knot = 0; knot < (moves ? segments + 1 : 1); ++knot)
            for (glm::vec3& p : points) {
                world.motion.points.push_back(p);
                p += 0.1f * glm::vec3(random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0));
            }
        world.add_part(part);
    };
    part_of(1, false);
    part_of(1, true);
    part_of(3, true);
}

// As the light sees it, in pixels, for the exact test.
Frame in_texels(const World& world, const LightView& light) {
    Frame frame = world.frame;
    frame.view.width = frame.view.height = kWidth;
    frame.view.perspective = light.perspective;
    frame.view.depth_near = light.perspective ? kNearestToLight : -1e30;
    frame.view.depth_far = 1e30;
    for (const glm::vec3& point : world.motion.points) {
        const glm::vec3 p = light.place(point);
        frame.points.emplace_back(kScale * p.x, kScale * p.y, light.perspective ? p.z : 1.0f, 0.0f);
        frame.depths.push_back(p.z);
    }
    return frame;
}

// The nearest depth at each sample of a cell: every triangle against every sample.
std::vector<float> exact_depths(const Frame& frame, const ShadowSamples::Cell& samples, const CellCentre& centre) {
    std::vector<float> depths(ShadowSamples::kPerCell, INFINITY);
    for (std::uint32_t triangle = 0; triangle < frame.triangle_count(); ++triangle)
        for (int segment = 0; segment < frame.parts[frame.part_of[triangle]].segments; ++segment) {
            const LocalTriangle local = localize(frame, triangle, segment, centre);
            for (int i = 0; i < ShadowSamples::kPerCell; ++i) {
                const SampleHit hit = cover_sample(local, {samples.x[i], samples.y[i], 0, 0, samples.t[i]}, centre);
                if (hit.hit) depths[i] = std::min(depths[i], hit.depth);
            }
        }
    return depths;
}

TEST(ShadowRaster, SamplesAreThoseOfTheTableMovedALittleAndWordsSayWhere) {
    const ShadowSamples samples(3);
    for (int cell = 0; cell < 36; ++cell) {
        const int cx = cell % 6, cy = cell / 6;
        const ShadowSamples::Cell& places = samples.cell(cx, cy);
        for (int i = 0; i < ShadowSamples::kPerCell; ++i) {
            const int texel = i / ShadowSamples::kSamples, column = texel % kCellSize, row = texel / kCellSize;
            const int px = cx * kCellSize + column, py = cy * kCellSize + row, quarter = i % ShadowSamples::kSamples;
            int index = 0;
            while (samples.table().slot_of(px, py, index) != quarter) ++index;
            const LocalSample expected = local_sample(samples.table().sample(px, py, index), px, py);
            ASSERT_LE(std::abs(places.x[i] - expected.hx), 0x1p-13f) << i;
            ASSERT_LE(std::abs(places.y[i] - expected.hy), 0x1p-13f) << i;
            ASSERT_LE(std::abs(places.t[i] - expected.t), 0x1p-11f) << i;
            const auto word = static_cast<std::uint32_t>(samples.words(cx, cy)[i]);
            ASSERT_EQ(places.x[i], static_cast<float>(column - 16) + (0.5f + static_cast<float>(word & 4095)) / 4096);
            ASSERT_EQ(places.y[i],
                      static_cast<float>(15 - row) + (0.5f + static_cast<float>(word >> 12 & 4095)) / 4096);
            ASSERT_EQ(places.t[i], (static_cast<float>(quarter) + (0.5f + static_cast<float>(word >> 24)) / 256) / 4);
            ASSERT_EQ(samples.times()[samples.index_of(cx, cy) * ShadowSamples::kPerCell + i], word >> 24);
        }
    }
}

TEST(ShadowRaster, ACellHoldsWhatTheExactTestSeesOnEveryCpuTarget) {
    support::Random random(7);
    const ShadowSamples samples(3);
    std::size_t hits_seen = 0, differ = 0, wrong = 0;
    for (int round = 0; round < 10; ++round)
        for (const bool perspective : {true, false}) {
            World world;
            fill(world, random);
            LightView view;
            view.perspective = perspective;
            const Frame exact = in_texels(world, view);
            const Casters casters = make_casters(world.motion, view, false);
            std::vector<std::uint32_t> list(casters.count);
            for (std::uint32_t i = 0; i < list.size(); ++i) list[i] = i;
            for (int cell = 0; cell < 4; ++cell) {
                const int cx = cell % 2, cy = cell / 2;
                const ShadowCellWork work{casters, list, samples, cx, cy, kWidth, kScale};
                AlignedVector<float> depths(ShadowSamples::kPerCell), bounds(ShadowSamples::kPerCell);
                AlignedVector<float> others(ShadowSamples::kPerCell), other_bounds(ShadowSamples::kPerCell);
                draw_shadow_cell()(work, depths.data(), bounds.data());
                for (const char* isa : {"scalar", "avx2", "avx512"}) {
                    if (!support::has_isa(isa)) continue;
                    const support::UseIsa use(isa);
                    draw_shadow_cell()(work, others.data(), other_bounds.data());
                    EXPECT_EQ(std::memcmp(depths.data(), others.data(), sizeof(float) * depths.size()), 0) << isa;
                    EXPECT_EQ(std::memcmp(bounds.data(), other_bounds.data(), sizeof(float) * bounds.size()), 0) << isa;
                }
                const std::vector<float> exact_ones =
                    exact_depths(exact, samples.cell(cx, cy), cell_centre(exact.view, cx, cy));
                for (int i = 0; i < ShadowSamples::kPerCell; ++i) {
                    const float expected = exact_ones[i];
                    hits_seen += std::isfinite(expected);
                    wrong += !(bounds[i] >= depths[i]) || std::isfinite(bounds[i]) != std::isfinite(depths[i]);
                    differ += !(depths[i] == expected || std::abs(depths[i] - expected) < 1e-4f * expected);
                }
            }
        }
    EXPECT_GT(hits_seen, 100000u);
    EXPECT_EQ(wrong, 0u);
    EXPECT_LT(differ, hits_seen / 10000);  // rounding at an edge decides
}

// A square whose depth grows by 3 from left to right, over 64 texels.
TEST(ShadowRaster, BeyondASampleItsTriangleMayRecedeByHalfATexelButNotBeyondItsEnd) {
    World world;
    Part part;
    part.triangle_count = 2;
    part.vertex_count = 4;
    world.add_part(part);
    world.motion.points = {{-1, -1, 2}, {1, -1, 5}, {1, 1, 5}, {-1, 1, 2}};
    world.frame.corners = {0, 1, 2, 0, 2, 3};
    world.frame.part_of = {0, 0};
    const Casters casters = make_casters(world.motion, LightView{}, false);
    const ShadowSamples samples(3);
    const std::vector<std::uint32_t> list = {0, 1};
    AlignedVector<float> depths(ShadowSamples::kPerCell), bounds(ShadowSamples::kPerCell);
    for (int cx = 0; cx < 2; ++cx) {
        draw_shadow_cell()({casters, list, samples, cx, 0, kWidth, kScale}, depths.data(), bounds.data());
        for (int i = 0; i < ShadowSamples::kPerCell; ++i) {
            const float x = samples.cell(cx, 0).x[i] + kCellSize * (cx - 0.5f);
            EXPECT_NEAR(depths[i], 3.5f + 3.0f / 64.0f * x, 1e-5f);
            EXPECT_NEAR(bounds[i], std::min(depths[i] + 1.5f / 64.0f, 5.0f), 1e-5f);
        }
    }
}

}  // namespace
}  // namespace pentaprism
