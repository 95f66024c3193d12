// Large triangles under --focus-range: pieces lie in the triangle, leave no gap, and blur as the lens says.
#include "frame/cut_triangles.h"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <set>

#include "support/random.h"
#include "unit/small_scene.h"

namespace pentaprism {
namespace {

using support::Random;

// A floor from 1 m to 60 m, seen at a slant, sharp from 5 m to 9 m; turned by a shear, so that no edge has one depth.
Scene floor_scene(bool mirrored) {
    Scene scene = small_scene::scene_with_camera();
    Primitive floor;
    floor.positions = {{-9, -1, -1}, {11, -1, -3}, {12, -1, -60}, {-8, -1, -50}};
    floor.normals.assign(4, {0, 1, 0});
    floor.texcoords[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    floor.indices = {0, 1, 2, 0, 2, 3};
    const Index node = small_scene::add_mesh(scene, {floor});
    if (mirrored) scene.nodes[node].transform.scale.x = -1.0;
    scene.materials.emplace_back();
    scene.materials[0].double_sided = true;
    scene.meshes[0].primitives[0].material = 0;
    return scene;
}

Frame floor_frame(const Scene& scene) {
    RenderSettings settings;
    settings.image.width = 320;
    settings.image.height = 200;
    settings.camera.lens_radius = 0.3;
    settings.camera.focus_range = {5.0, 9.0};
    settings.camera.max_foreground_blur = 12;
    return small_scene::frame_of(scene, settings);
}

TEST(CutTriangles, BlurAsTheLensSaysWithinHalfAPixel) {
    const Scene scene = floor_scene(false);
    const Frame frame = floor_frame(scene);
    ASSERT_EQ(frame.pieces.size(), frame.triangle_count());
    EXPECT_GT(frame.triangle_count(), 20u);
    EXPECT_LT(frame.triangle_count(), 2000u);
    Random r(3);
    double worst = 0.0;
    for (std::uint32_t i = 0; i < frame.triangle_count(); ++i) {
        const MovingTriangle m = moving_triangle(frame, i, 0);
        for (int k = 0; k < 20; ++k) {
            double b[3] = {r.unit(), r.unit(), r.unit()};
            const double sum = b[0] + b[1] + b[2];
            double w = 0, c = 0;
            for (int j = 0; j < 3; ++j) w += b[j] / sum * m.w[j][0], c += b[j] / sum * m.c[j][0];
            worst = std::max(worst, std::abs(c - frame.view.coc(0, 0, w)) / w);
        }
    }
    EXPECT_LT(worst, 0.75) << "edges keep to 0.5, the inside of a triangle may add a little";
    EXPECT_GT(worst, 0.05) << "cut in vain";
}

TEST(CutTriangles, LieInTheWholeTriangleAndKnowWhere) {
    for (const bool mirrored : {false, true}) {
        const Scene scene = floor_scene(mirrored);
        const Frame frame = floor_frame(scene);
        EXPECT_EQ(frame.parts[0].mirrored, mirrored);
        double area[2] = {0, 0};
        for (std::uint32_t i = 0; i < frame.triangle_count(); ++i) {
            const MovingTriangle piece = moving_triangle(frame, i, 0);
            const auto vertices = frame.vertices(i);
            for (int k = 0; k < 3; ++k) {
                const glm::vec3 b = frame.in_source(i, {k == 0, k == 1, k == 2});
                glm::vec4 expected(0.0f);
                for (int j = 0; j < 3; ++j) expected += b[j] * frame.points[frame.parts[0].first_point + vertices[j]];
                EXPECT_NEAR(piece.x[k][0], expected.x, 1e-3);
                EXPECT_NEAR(piece.y[k][0], expected.y, 1e-3);
                EXPECT_NEAR(piece.w[k][0], expected.z, 1e-4);
            }
            const glm::vec2* p = frame.pieces[i].corner;
            const glm::vec2 e = p[1] - p[0], f = p[2] - p[0];
            EXPECT_GT(e.x * f.y - e.y * f.x, 0.0f) << "turned over";
            ASSERT_LT(frame.source(i), 2u);
            area[frame.source(i)] += e.x * f.y - e.y * f.x;
        }
        EXPECT_NEAR(area[0], 1.0, 1e-6) << "pieces pave the triangle";
        EXPECT_NEAR(area[1], 1.0, 1e-6);
    }
}

TEST(CutTriangles, ShareEveryInnerEdgeWithOneNeighbour) {
    const Scene scene = floor_scene(false);
    const Frame frame = floor_frame(scene);
    EXPECT_GT(frame.triangle_count(), 20u);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;  // +1 one way, -1 the other
    std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
    for (std::uint32_t i = 0; i < frame.triangle_count(); ++i)
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t a = frame.corners[3 * i + k], b = frame.corners[3 * i + (k + 1) % 3];
            EXPECT_TRUE(seen.emplace(a, b).second) << "an edge twice in one direction";
            edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
        }
    // What has no neighbour lies on the floor's own border: each of those points is on one of its four sides.
    for (const auto& [edge, balance] : edges) {
        if (balance == 0) continue;
        const glm::vec4 p = frame.points[edge.first], q = frame.points[edge.second];
        int sides = 0;
        const auto& corners = scene.meshes[0].primitives[0].positions;
        for (int k = 0; k < 4; ++k) {
            const glm::dvec2 a(corners[k].x * frame.view.fx, -corners[k].z),
                b(corners[(k + 1) % 4].x * frame.view.fx, -corners[(k + 1) % 4].z);
            const auto off = [&](const glm::vec4& v) {
                const glm::dvec2 d = b - a, e = glm::dvec2(v.x, v.z) - a;
                return std::abs(d.x * e.y - d.y * e.x) / glm::length(d);
            };
            sides += off(p) < 1e-2 && off(q) < 1e-2;
        }
        EXPECT_GE(sides, 1) << "a crack";
    }
}

TEST(CutTriangles, OfAFloorWithoutEndAreFew) {
    // Also where the floor passes under the camera and lies askew.
    for (const double turn : {0.0, 0.3, 0.785}) {
        Scene scene = small_scene::scene_with_camera();
        Primitive floor;
        floor.positions = {{-1e5f, -1, 1e5f}, {1e5f, -1, 1e5f}, {1e5f, -1, -1e5f}, {-1e5f, -1, -1e5f}};
        floor.indices = {0, 1, 2, 0, 2, 3};
        const Index node = small_scene::add_mesh(scene, {floor});
        scene.nodes[node].transform.rotation = glm::dquat(std::cos(turn / 2), 0, std::sin(turn / 2), 0);
        const Frame frame = floor_frame(scene);
        EXPECT_GT(frame.triangle_count(), 15u) << turn;
        EXPECT_LT(frame.triangle_count(), 50u) << turn;
    }
}

TEST(CutDepths, AreAsFineAsTheBlurBendsAndFinerForWhatMoves) {
    const Scene scene = floor_scene(false);
    const View view = floor_frame(scene).view;
    const std::vector<double> still = cut_depths(std::span(&view, 1), 0.0),
                              moving = cut_depths(std::span(&view, 1), 2.0);
    EXPECT_LT(still.size(), 30u);
    EXPECT_NEAR(still.back(), 10.0, 1e-9) << "where blur is real again";
    const auto worst = [&](const std::vector<double>& depths, double shift) {
        double most = 0.0;
        for (std::size_t i = 0; i + 1 < depths.size(); ++i)
            for (int k = 1; k < 32; ++k) {
                const double p = depths[i] + shift, q = depths[i + 1] + shift, s = k / 32.0, z = p + s * (q - p);
                const double c = view.coc(0, 0, p) + s * (view.coc(0, 0, q) - view.coc(0, 0, p));
                if (p > view.depth_near) most = std::max(most, std::abs(c - view.coc(0, 0, z)) / z);
            }
        return most;
    };
    EXPECT_LT(worst(still, 0.0), 0.5);
    EXPECT_GT(worst(still, 0.7), 0.5) << "what moves needs more";
    for (const double shift : {-2.0, -0.7, 0.7, 1.9}) EXPECT_LT(worst(moving, shift), 0.5) << shift;
    EXPECT_LT(moving.size(), 400u);
    EXPECT_LT(cut_depths(std::span(&view, 1), 1e6).size(), 10'000u) << "however far it goes";
}

TEST(CutTriangles, LeaveARealLensAlone) {
    const Scene scene = floor_scene(false);
    RenderSettings settings;
    settings.camera.lens_radius = 0.3;
    settings.camera.focus_distance = 6;
    EXPECT_TRUE(small_scene::frame_of(scene, settings).pieces.empty());
    settings.camera.focus_range = {5.0, 9.0};
    settings.camera.defocus = false;
    EXPECT_TRUE(small_scene::frame_of(scene, settings).pieces.empty()) << "a pinhole";
}

}  // namespace
}  // namespace pentaprism
