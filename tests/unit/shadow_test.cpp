#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <numbers>

#include "sample/net.h"
#include "shade/shadows.h"
#include "small_scene.h"

namespace pentaprism {
namespace {

using namespace small_scene;

// A floor y = 0 of half width `size`, two triangles.
Primitive floor_of(float size) {
    Primitive floor = square(size, 0.0f, kNone);
    for (glm::vec3& p : floor.positions) p = {p.x, 0.0f, -p.y};
    floor.normals.assign(4, {0.0f, 1.0f, 0.0f});
    return floor;
}

// Scene, frame and shadows of one light above a floor.
struct Stage {
    Scene scene = scene_with_camera();
    RenderSettings settings;
    Frame frame;
    Lighting lighting;
    std::unique_ptr<Shadows> shadows;

    Stage() {
        settings.image.width = settings.image.height = 64;
        add_mesh(scene, {floor_of(20.0f)});
    }
    void add_sun(const glm::vec3& travels) {
        lighting.lights.push_back(
            {LightKind::kDirectional, {}, glm::normalize(travels), glm::vec3(1.0f), INFINITY, 1, 0});
    }
    void add_lamp(const glm::vec3& position) {
        lighting.lights.push_back({LightKind::kPoint, position, {0, -1, 0}, glm::vec3(1.0f), INFINITY, 1, 0});
    }
    void move(Index node, const glm::vec3& from, const glm::vec3& to) {
        // From shutter open to close: the shutter is 1/48 s around time 0.
        Channel path;
        path.node = node;
        path.times = {-1.0f / 96.0f, 1.0f / 96.0f};
        path.values = {from.x, from.y, from.z, to.x, to.y, to.z};
        scene.nodes[node].transform.translation = 0.5f * (from + to);
        scene.animations.push_back({"move", {path}, 1.0});
    }
    void finish(ShadowMode mode = ShadowMode::kMoving) {
        frame = frame_of(scene, settings);
        shadows = std::make_unique<Shadows>(frame, lighting, glm::dvec3(0.0), mode);
    }
    // Light at the point of the triangle, mean over many seeds in one quarter of the shutter or all of it.
    double lit(std::uint32_t triangle, const glm::vec3& b, float texel, int quarter = -1, int seeds = 64) const {
        const WorldMotion world = world_motion(frame, glm::dvec3(0.0), true);
        glm::vec3 position(0.0f);
        for (int i = 0; i < 3; ++i) position += b[i] * world.points[world.corners(triangle)[i]];
        const ShadowCellStore::Visit visit(shadows->store());
        ShadowsOnTriangle on_triangle;
        on_triangle.start(*shadows, triangle);
        ShadowPoint point;
        for (int k = 0; k < 3; ++k) std::fill_n(point.barycentrics[k], ShadowPoint::kLanes, b[k]);
        point.position = position;
        point.texel = texel;
        double sum = 0.0;
        for (int s = 0; s < seeds; ++s) {
            const int q = quarter < 0 ? s % 4 : quarter;
            point.quarters = 1u << q;
            sum += 0.25 * std::popcount(on_triangle.lit(0, point, mix(s)) >> 4 * q & 15u);
        }
        return sum / seeds;
    }
    // The same at (x, z) of the floor, triangles 0 and 1.
    double floor_lit(float x, float z, float texel, int quarter = -1) const {
        const float u = (x + 20.0f) / 40.0f, v = (20.0f - z) / 40.0f;  // corners: (0,0) (1,0) (1,1) (0,1)
        const bool first = u >= v;
        return first ? lit(0, {1.0f - u, u - v, v}, texel, quarter) : lit(1, {1.0f - v, u, v - u}, texel, quarter);
    }
};

Primitive lid(float size, float height) {
    Primitive top = floor_of(size);
    for (glm::vec3& p : top.positions) p.y = height;
    return top;
}

TEST(Shadows, AFloorDoesNotShadowItselfAtAnyHeightOfTheSun) {
    for (const double degrees : {2.0, 10.0, 30.0, 60.0, 80.0, 90.0}) {
        Stage stage;
        const double angle = degrees * std::numbers::pi / 180.0;
        stage.add_sun({0.6f * static_cast<float>(std::cos(angle)), -static_cast<float>(std::sin(angle)),
                       0.8f * static_cast<float>(std::cos(angle))});
        stage.finish();
        for (int i = 0; i < 40; ++i)
            EXPECT_EQ(stage.floor_lit(-7.3f + 0.37f * i, 5.1f - 0.21f * i, 0.02f), 1.0) << degrees << " " << i;
    }
}

// A slope that falls towards +x and one that rises again from its foot at x = 0, both in light: no facet stands before
// another, though each one's plane goes on behind the other.
TEST(Shadows, AFoldThatLightGrazesIsNotDarkAlongItsFoot) {
    for (const double turn : {0.0, 0.4})
        for (const float rise : {-0.5f, 0.2f, 4.0f}) {
            Stage stage;
            Primitive fold = square(4.0f, 0.0f, kNone);
            fold.positions = {{-4, 8, 4}, {0, 0, 4}, {0, 0, -4}, {-4, 8, -4}, {4, 4 * rise, 4}, {4, 4 * rise, -4}};
            for (glm::vec3& p : fold.positions) p.y += 10.0f;
            fold.normals.clear();
            fold.texcoords[0].clear();
            fold.indices = {0, 1, 3, 1, 2, 3, 1, 4, 2, 4, 5, 2};
            add_mesh(stage.scene, {fold});
            // Along the texels' axes, and turned off them.
            stage.add_sun({-0.1f, -1.0f, static_cast<float>(turn)});
            stage.finish();
            double before = 0.0, beyond = 0.0;
            for (int i = 0; i < 40; ++i) {
                const float along = 0.1f + 0.011f * static_cast<float>(i), near = 0.0004f * static_cast<float>(i);
                before += stage.lit(3, {along, 1.0f - along - near, near}, 0.02f, -1, 16) / 40.0;
                beyond += stage.lit(4, {1.0f - along - near, near, along}, 0.02f, -1, 16) / 40.0;
            }
            // 0.9 to 0.97 with planes that do not end where their triangles do.
            EXPECT_GT(before, 0.985) << turn << " " << rise;
            EXPECT_GT(beyond, 0.985) << turn << " " << rise;
        }
}

TEST(Shadows, AShadowBeginsWhereItsCasterStandsAndEndsWhereItShould) {
    Stage stage;
    Primitive wall = square(1.0f, 0.0f, kNone);  // x in [-1, 1], y in [0, 2], at z = 0
    for (glm::vec3& p : wall.positions) p.y += 1.0f;
    add_mesh(stage.scene, {wall});
    stage.add_sun({0.0f, -1.0f, 1.0f});  // 45 degrees, to +z
    stage.finish();
    const float texel = 0.01f;
    EXPECT_EQ(stage.floor_lit(0.0f, -0.03f, texel), 1.0);
    EXPECT_EQ(stage.floor_lit(0.0f, 0.03f, texel), 0.0);  // no gap under the wall
    EXPECT_EQ(stage.floor_lit(0.0f, 1.97f, texel), 0.0);
    EXPECT_EQ(stage.floor_lit(0.0f, 2.03f, texel), 1.0);
    EXPECT_EQ(stage.floor_lit(0.97f, 1.0f, texel), 0.0);
    EXPECT_EQ(stage.floor_lit(1.03f, 1.0f, texel), 1.0);
}

TEST(Shadows, TheShadowOfAMovingLidIsASlopeAndAFrozenOneIsAnEdge) {
    const auto stage_of = [](ShadowMode mode) {
        auto stage = std::make_unique<Stage>();
        const Index lid_node = add_mesh(stage->scene, {lid(1.0f, 2.0f)});
        stage->move(lid_node, {-1.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f});
        stage->add_sun({0.0f, -1.0f, 0.0f});
        stage->finish(mode);
        return stage;
    };
    const auto moving = stage_of(ShadowMode::kMoving), still = stage_of(ShadowMode::kStill);
    // The lid covers [-2, 0] when the shutter opens and [0, 2] when it closes: x is dark for 1 - |x| / 2 of the time.
    for (const float x : {-1.6f, -1.1f, -0.5f, -0.2f, 0.4f, 0.9f, 1.7f}) {
        double mean = 0.0;
        for (int i = 0; i < 25; ++i) mean += moving->floor_lit(x, -0.5f + 0.041f * static_cast<float>(i), 0.02f) / 25;
        EXPECT_NEAR(mean, 0.5 * std::abs(x), 0.04) << x;
        EXPECT_EQ(still->floor_lit(x, 0.1f, 0.02f), std::abs(x) < 1.0f ? 0.0 : 1.0) << x;
    }
}

TEST(Shadows, AMapsTimesAreSpreadOverEachQuarterOfTheShutter) {
    Stage stage;
    const Index lid_node = add_mesh(stage.scene, {lid(1.0f, 2.0f)});
    stage.move(lid_node, {-4.0f, 0.0f, 0.0f}, {4.0f, 0.0f, 0.0f});
    stage.add_sun({0.0f, -1.0f, 0.0f});
    stage.finish();
    // In the second quarter the lid's middle goes from -2 to 0: x = -2.5 is dark in the first quarter of that, and
    // neighbouring texels see different times of it.
    double mean = 0.0, square = 0.0;
    for (int i = 0; i < 400; ++i) {
        const float z = -0.9f + 0.0045f * static_cast<float>(i);
        const double here = stage.floor_lit(-2.5f, z, 0.002f, 1) / 400.0;
        mean += here;
        square += 400.0 * here * here;
    }
    EXPECT_NEAR(mean, 0.75, 0.04);
    EXPECT_GT(square - mean * mean, 0.01);
}

TEST(Shadows, ASurfaceThatMovesFastDoesNotShadowItself) {
    Stage stage;
    Primitive step = lid(1.0f, 1.0f);
    Primitive riser = square(1.0f, 0.0f, kNone);  // behind the lid's far edge and up
    for (glm::vec3& p : riser.positions) p = {p.x, p.y + 2.0f, -1.0f};
    const Index node = add_mesh(stage.scene, {step, riser});
    stage.move(node, {-1.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f});
    stage.add_sun({0.2f, -1.0f, -0.5f});
    stage.finish();
    for (int i = 0; i < 50; ++i) {
        const float u = 0.05f + 0.018f * static_cast<float>(i);
        EXPECT_GT(stage.lit(2, {1.0f - u, 0.6f * u, 0.4f * u}, 0.01f), 0.99) << i;
        EXPECT_GT(stage.lit(4, {1.0f - u, 0.6f * u, 0.4f * u}, 0.01f), 0.99) << i;
    }
}

TEST(Shadows, APointLightShadowsInAllDirections) {
    for (const glm::vec3& way : {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 0, 1), glm::vec3(0, 0, -1),
                                 glm::vec3(0.71f, 0, 0.7f), glm::vec3(-0.7f, 0, 0.71f), glm::vec3(0, 0, 0)}) {
        Stage stage;
        // A lid of half a metre halfway between the lamp, 2 m above the floor, and the floor 4 m away along `way`.
        Primitive block = lid(0.25f, 1.0f);
        for (glm::vec3& p : block.positions) p += 2.0f * way;
        add_mesh(stage.scene, {block});
        stage.add_lamp({0.0f, 2.0f, 0.0f});
        stage.finish();
        const glm::vec3 middle = 4.0f * way, aside = middle + glm::vec3(0.55f, 0.0f, 0.55f);
        EXPECT_EQ(stage.floor_lit(middle.x, middle.z, 0.01f), 0.0) << way.x << " " << way.z;
        EXPECT_EQ(stage.floor_lit(middle.x + 0.47f, middle.z, 0.01f), 0.0);
        EXPECT_EQ(stage.floor_lit(middle.x + 0.53f, middle.z, 0.01f), 1.0);
        EXPECT_EQ(stage.floor_lit(aside.x, aside.z, 0.01f), 1.0);
    }
}

TEST(Shadows, TheSizeOfTexelsDoesNotMoveAShadow) {
    Stage stage;
    add_mesh(stage.scene, {lid(1.0f, 2.0f)});
    stage.add_sun({0.3f, -1.0f, 0.1f});
    stage.finish();
    for (const float texel : {0.001f, 0.004f, 0.016f, 0.064f}) {
        EXPECT_EQ(stage.floor_lit(0.6f + 0.9f, 0.2f, texel), 0.0) << texel;
        EXPECT_EQ(stage.floor_lit(0.6f + 1.15f, 0.2f, texel), 1.0) << texel;
    }
}

TEST(Shadows, CellsThatWereForgottenAreDrawnTheSameAgain) {
    Stage stage;
    stage.move(add_mesh(stage.scene, {square(0.7f, 0.0f, kNone)}), {0.0f, 1.0f, 0.0f}, {0.5f, 1.0f, 0.0f});
    stage.add_lamp({0.0f, 3.0f, 0.0f});
    stage.finish();
    LightView view;
    view.perspective = true;
    view.position = {0.0f, 3.0f, 0.0f};
    view.axes = {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}};
    const Shadows& shadows = *stage.shadows;
    constexpr int kWidth = 2048, kCells = kWidth / kCellSize;
    ShadowCellStore few(ShadowSamples::kPerCell, 2), all(ShadowSamples::kPerCell, 10000);
    const ShadowMap forgetful(shadows.world(), shadows.samples(), few, view, kWidth);
    const ShadowMap keeping(shadows.world(), shadows.samples(), all, view, kWidth);
    int hits = 0;
    for (int round = 0; round < 2; ++round)
        for (int cell = 0; cell < 64; ++cell) {
            const ShadowCellStore::Visit a(few), b(all);
            const int cx = kCells / 2 - 4 + cell % 8, cy = kCells / 2 - 4 + cell / 8, limit = kLimits - 1;
            const float* again = forgetful.depths(-6, limit, cx, cy);
            const float* kept = keeping.depths(-6, limit, cx, cy);
            ASSERT_EQ(std::memcmp(again, kept, sizeof(float) * ShadowSamples::kPerCell), 0);
            hits += !ShadowMap::is_empty(kept);
        }
    EXPECT_GT(hits, 100);
    EXPECT_EQ(keeping.cells_rendered(), 64);
    EXPECT_GT(forgetful.cells_rendered(), 100);
}

}  // namespace
}  // namespace pentaprism
