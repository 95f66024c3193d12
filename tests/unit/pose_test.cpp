// Poses that can be worked out by hand.

#include "scene/pose.h"

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>
#include <pentaprism/error.h>

#include "scene/keyframes.h"

namespace pentaprism {
namespace {

Channel channel(ChannelPath path, Interpolation interpolation, int width, std::vector<float> times,
                std::vector<float> values) {
    Channel result;
    result.node = 0;
    result.path = path;
    result.interpolation = interpolation;
    result.width = width;
    result.times = std::move(times);
    result.values = std::move(values);
    return result;
}

std::vector<double> sample(const Channel& channel, double time) {
    std::vector<double> out(static_cast<std::size_t>(channel.width));
    sample_channel(channel, time, out);
    return out;
}

TEST(Keyframes, HoldBeforeTheFirstAndAfterTheLastKey) {
    const Channel linear = channel(ChannelPath::kTranslation, Interpolation::kLinear, 3, {1, 2}, {1, 2, 3, 5, 6, 7});
    EXPECT_EQ(sample(linear, -3), (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(sample(linear, 9), (std::vector<double>{5, 6, 7}));
    EXPECT_EQ(sample(linear, 1.25), (std::vector<double>{2, 3, 4}));
}

TEST(Keyframes, StepsJumpExactlyAtTheKey) {
    const Channel step = channel(ChannelPath::kScale, Interpolation::kStep, 3, {0, 1}, {1, 1, 1, 2, 2, 2});
    EXPECT_EQ(sample(step, 0.9999)[0], 1.0);
    EXPECT_EQ(sample(step, 1.0)[0], 2.0);
}

TEST(Keyframes, RotationsTurnAtConstantSpeedAlongTheShorterArc) {
    // From 0 to 90 degrees about y; the second key has the other sign, which is the same rotation.
    const float h = static_cast<float>(std::sqrt(0.5));
    const Channel turn = channel(ChannelPath::kRotation, Interpolation::kLinear, 4, {0, 1}, {0, 0, 0, 1, 0, -h, 0, -h});
    for (const double time : {0.1, 0.25, 0.5, 0.9}) {
        const auto q = sample(turn, time);
        const double angle = time * glm::half_pi<double>();
        EXPECT_NEAR(q[1], std::sin(angle / 2), 1e-7);
        EXPECT_NEAR(q[3], std::cos(angle / 2), 1e-7);
    }
}

TEST(Keyframes, CubicSplinesTakeTangentsPerSecond) {
    // Two seconds between keys, leaving with 3 units a second, arriving with 0: Hermite's curve.
    const Channel spline = channel(ChannelPath::kTranslation, Interpolation::kCubicSpline, 3, {1, 3},
                                   {0, 0, 0, 10, 0, 0, 3, 0, 0, /**/ 0, 0, 0, 20, 0, 0, 0, 0, 0});
    const auto expected = [](double s) {
        return (2 * s * s * s - 3 * s * s + 1) * 10 + (s * s * s - 2 * s * s + s) * 2 * 3 +
               (3 * s * s - 2 * s * s * s) * 20;
    };
    for (const double s : {0.0, 0.25, 0.5, 0.75}) EXPECT_NEAR(sample(spline, 1 + 2 * s)[0], expected(s), 1e-12);
    EXPECT_EQ(sample(spline, 3)[0], 20.0);
}

/// A triangle (0,0,0), (1,0,0), (0,1,0) with normals along z on one node.
Scene triangle_scene() {
    Scene scene;
    Primitive primitive;
    primitive.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    primitive.normals.assign(3, {0, 0, 1});
    primitive.indices = {0, 1, 2};
    scene.meshes.push_back({"", {primitive}, {}});
    scene.nodes.emplace_back();
    scene.nodes[0].mesh = 0;
    scene.roots = {0};
    return scene;
}

std::vector<glm::dvec3> positions(const Scene& scene, std::size_t placement, double time) {
    const Pose pose = evaluate(scene, choose_animations(scene, "all"), time);
    const Placement place = placements(scene).at(placement);
    std::vector<glm::dvec3> out(scene.meshes[static_cast<std::size_t>(place.mesh)]
                                    .primitives[static_cast<std::size_t>(place.primitive)]
                                    .positions.size());
    pose_positions(scene, pose, place, out);
    return out;
}

std::vector<glm::vec3> normals(const Scene& scene, double time) {
    const Pose pose = evaluate(scene, choose_animations(scene, "all"), time);
    std::vector<glm::vec3> out(scene.meshes[0].primitives[0].normals.size());
    pose_normals(scene, pose, placements(scene).at(0), out);
    return out;
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-6) {
    EXPECT_LT(glm::distance(a, b), tolerance)
        << a.x << ' ' << a.y << ' ' << a.z << " instead of " << b.x << ' ' << b.y << ' ' << b.z;
}

TEST(Pose, ChildrenFollowTheirParents) {
    Scene scene = triangle_scene();
    // Node 0 becomes a child of node 1, which turns a quarter about z and is twice as large.
    Node parent;
    parent.children = {0};
    parent.transform.translation = {10, 0, 0};
    parent.transform.rotation = glm::angleAxis(glm::half_pi<double>(), glm::dvec3(0, 0, 1));
    parent.transform.scale = glm::dvec3(2.0);
    scene.nodes.push_back(parent);
    scene.nodes[0].parent = 1;
    scene.nodes[0].transform.translation = {1, 0, 0};
    scene.roots = {1};
    const auto out = positions(scene, 0, 0.0);
    expect_near(out[0], {10, 2, 0});
    expect_near(out[1], {10, 4, 0});
    expect_near(out[2], {8, 2, 0});
}

TEST(Pose, InstancesLieWithinTheirNode) {
    Scene scene = triangle_scene();
    scene.nodes[0].transform.scale = glm::dvec3(3.0);
    scene.nodes[0].instances.resize(2);
    scene.nodes[0].instances[1].translation = {1, 1, 1};
    ASSERT_EQ(placements(scene).size(), 2u);
    EXPECT_EQ(count_triangles(scene), 2);
    expect_near(positions(scene, 1, 0.0)[1], {6, 3, 3});
}

TEST(Pose, MorphTargetsAddUp) {
    Scene scene = triangle_scene();
    scene.meshes[0].primitives[0].targets.resize(2);
    scene.meshes[0].primitives[0].targets[0].positions = {{0, 0, 1}, {0, 0, 0}, {0, 0, 0}};
    scene.meshes[0].primitives[0].targets[1].positions = {{0, 0, 10}, {0, 0, 20}, {0, 0, 0}};
    scene.meshes[0].weights = {0.5f, 0.25f};
    expect_near(positions(scene, 0, 0.0)[0], {0, 0, 3});
    expect_near(positions(scene, 0, 0.0)[1], {1, 0, 5});
    scene.nodes[0].weights = {1.0f, 0.0f};
    expect_near(positions(scene, 0, 0.0)[0], {0, 0, 1});
    scene.animations.push_back(
        {"", {channel(ChannelPath::kWeights, Interpolation::kLinear, 2, {0, 2}, {0, 0, 1, 1})}, 2.0});
    expect_near(positions(scene, 0, 1.0)[0], {0, 0, 5.5});
    EXPECT_FALSE(is_rigid(scene, placements(scene)[0]));
}

TEST(Pose, NormalsStandOnSquashedAndMirroredSurfaces) {
    Scene scene = triangle_scene();
    scene.meshes[0].primitives[0].normals.assign(3, glm::normalize(glm::vec3(1, 0, 1)));
    scene.nodes[0].transform.scale = {0.5, 1, 1};
    for (const glm::vec3& normal : normals(scene, 0.0)) expect_near(normal, glm::normalize(glm::dvec3(2, 0, 1)));
    scene.nodes[0].transform.scale = {-1, 1, 1};
    const Pose pose = evaluate(scene, {}, 0.0);
    EXPECT_TRUE(is_mirrored(scene, pose, placements(scene)[0]));
    for (const glm::vec3& normal : normals(scene, 0.0)) expect_near(normal, glm::normalize(glm::dvec3(-1, 0, 1)));
}

TEST(Pose, FlattenedNormalsStayFinite) {
    Scene scene = triangle_scene();
    scene.nodes[0].transform.scale = {1, 1, 0};
    for (const glm::vec3& normal : normals(scene, 0.0)) expect_near(normal, {0, 0, 1});
}

TEST(Pose, SkinsBlendMatricesAndIgnoreTheirNode) {
    Scene scene = triangle_scene();
    Primitive& primitive = scene.meshes[0].primitives[0];
    primitive.influences = 4;
    primitive.joints = {0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0};
    primitive.weights = {1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 1, 0, 0, 0};
    scene.nodes.resize(3);
    scene.nodes[0].transform.translation = {100, 100, 100};
    scene.nodes[0].skin = 0;
    scene.nodes[2].transform.translation = {0, 0, 8};
    scene.roots = {0, 1, 2};
    scene.skins.push_back({"", {1, 2}, {glm::mat4(1.0f), glm::mat4(1.0f)}});
    const auto out = positions(scene, 0, 0.0);
    expect_near(out[0], {0, 0, 0});
    expect_near(out[1], {1, 0, 4});
    expect_near(out[2], {0, 1, 8});
    EXPECT_FALSE(is_rigid(scene, placements(scene)[0]));
}

TEST(Pose, OnlyWhatIsAnimatedMayMove) {
    Scene scene = triangle_scene();
    scene.nodes.resize(3);
    scene.nodes[1].children = {2};
    scene.nodes[2].parent = 1;
    scene.nodes[2].mesh = 0;
    scene.roots = {0, 1};
    Channel moving = channel(ChannelPath::kTranslation, Interpolation::kLinear, 3, {0, 1}, {0, 0, 0, 1, 0, 0});
    moving.node = 1;
    scene.animations.push_back({"go", {moving}, 1.0});
    const auto clips = choose_animations(scene, "go");
    const auto all = placements(scene);
    EXPECT_FALSE(may_move(scene, clips, all[0]));
    EXPECT_TRUE(may_move(scene, clips, all[1]));
    EXPECT_FALSE(may_move(scene, {}, all[1]));
}

TEST(Pose, UnknownAnimationsAreAUsageError) {
    Scene scene = triangle_scene();
    scene.animations.resize(2);
    scene.animations[1].name = "Walk";
    EXPECT_EQ(choose_animations(scene, "Walk"), std::vector<Index>{1});
    EXPECT_EQ(choose_animations(scene, "0"), std::vector<Index>{0});
    EXPECT_EQ(choose_animations(scene, "all").size(), 2u);
    for (const char* unknown : {"Run", "2", "-1", "1x"}) {
        try {
            choose_animations(scene, unknown);
            FAIL() << unknown;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::kUsage);
        }
    }
}

TEST(Pose, ADeepHierarchyNeedsNoDeepStack) {
    Scene scene = triangle_scene();
    constexpr Index kDepth = 200000;
    scene.nodes.resize(kDepth);
    for (Index i = 1; i < kDepth; ++i) {
        scene.nodes[static_cast<std::size_t>(i)].parent = i - 1;
        scene.nodes[static_cast<std::size_t>(i) - 1].children = {i};
        scene.nodes[static_cast<std::size_t>(i)].transform.translation = {1, 0, 0};
    }
    scene.nodes.back().mesh = 0;
    expect_near(positions(scene, 1, 0.0)[0], {kDepth - 1, 0, 0});
}

class RealPose : public testing::Test {
  protected:
    void SetUp() override {
        const char* folder = std::getenv("PENTAPRISM_SCENES");
        if (folder == nullptr) GTEST_SKIP() << "PENTAPRISM_SCENES is not set";
        folder_ = folder;
    }
    Scene load(const std::string& file) const { return load_scene((std::filesystem::path(folder_) / file).string()); }
    std::string folder_;
};

TEST_F(RealPose, SimpleSkinBendsByAQuarterTurnAtOneSecond) {
    const Scene scene = load("khronos/SimpleSkin/SimpleSkin.gltf");
    // The upper joint sits at (0, 1, 0) and turns 90 degrees; the strip's upper end, at (0.5, 2, 0), follows it wholly.
    glm::dvec3 leftmost(1e9);
    for (const glm::dvec3& point : positions(scene, 0, 1.0)) {
        if (point.x < leftmost.x || (point.x == leftmost.x && point.y > leftmost.y)) leftmost = point;
    }
    EXPECT_NEAR(leftmost.x, -1.0, 1e-3);
    const auto before = positions(scene, 0, 0.0);
    double top = 0.0;
    for (const glm::dvec3& point : before) top = std::max(top, point.y);
    EXPECT_DOUBLE_EQ(top, 2.0);
}

TEST_F(RealPose, SimpleMorphReachesItsSecondTarget) {
    const Scene scene = load("khronos/SimpleMorph/SimpleMorph.gltf");
    // Weights (0, 1) at one second: the tip (0.5, 0.5, 0) moves by (1, 1, 0).
    expect_near(positions(scene, 0, 1.0)[2], {1.5, 1.5, 0});
}

TEST_F(RealPose, AllInterpolationsMeetAtTheKeys) {
    const Scene scene = load("khronos/InterpolationTest/InterpolationTest.glb");
    ASSERT_EQ(scene.animations.size(), 9u);
    for (const Animation& animation : scene.animations) {
        const Channel& keys = animation.channels.at(0);
        const bool spline = keys.interpolation == Interpolation::kCubicSpline;
        for (std::size_t i = 0; i < keys.times.size(); ++i) {
            const auto value = sample(keys, keys.times[i]);
            const float* key = &keys.values[i * value.size() * (spline ? 3 : 1) + (spline ? value.size() : 0)];
            for (std::size_t k = 0; k < value.size(); ++k) EXPECT_NEAR(value[k], key[k], 1e-6) << animation.name;
        }
    }
}

TEST_F(RealPose, RecursiveSkeletonsPoseFinitely) {
    const Scene scene = load("khronos/RecursiveSkeletons/RecursiveSkeletons.glb");
    ASSERT_EQ(scene.skins.size(), 84u);
    ASSERT_EQ(placements(scene).size(), 84u);
    for (std::size_t i = 0; i < 84; ++i) {
        for (const glm::dvec3& point : positions(scene, i, 0.7)) ASSERT_LT(glm::length(point), 1000.0);
    }
}

TEST_F(RealPose, MorphStressMovesOnlyWithItsClips) {
    const Scene scene = load("khronos/MorphStressTest/MorphStressTest.glb");
    const auto clips = choose_animations(scene, "all");
    const auto all = placements(scene);
    int moving = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const bool moves = may_move(scene, clips, all[i]);
        const bool moved = positions(scene, i, 0.0) != positions(scene, i, 1.3);
        moving += moved;
        EXPECT_TRUE(moves || !moved);
        EXPECT_EQ(is_rigid(scene, all[i]), !moves);
    }
    EXPECT_GT(moving, 0);
}

TEST_F(RealPose, WheelsOfTheRaceTurnAtSeventyRadiansASecond) {
    const Scene scene = load("race/race.glb");
    const auto clips = choose_animations(scene, "all");
    // The fastest change of direction of any node that holds a mesh, over a time in which a wheel turns by 0.35 rad.
    double fastest = 0.0;
    const double step = 0.005;
    const Pose before = evaluate(scene, clips, 1.0), after = evaluate(scene, clips, 1.0 + step);
    for (const Placement& placement : placements(scene)) {
        const auto node = static_cast<std::size_t>(placement.node);
        for (int axis = 0; axis < 3; ++axis) {
            const glm::dvec3 a = glm::normalize(glm::dvec3(before.world[node][axis])),
                             b = glm::normalize(glm::dvec3(after.world[node][axis]));
            fastest = std::max(fastest, std::acos(glm::clamp(glm::dot(a, b), -1.0, 1.0)) / step);
        }
    }
    EXPECT_NEAR(fastest, 70.0, 15.0);
}

TEST_F(RealPose, AMillionVerticesTakeWellUnderASecond) {
    const Scene scene = load("khronos/MetalRoughSpheresNoTextures/MetalRoughSpheresNoTextures.glb");
    const auto start = std::chrono::steady_clock::now();
    const Pose pose = evaluate(scene, {}, 0.0);
    std::vector<glm::dvec3> out;
    std::size_t vertices = 0;
    for (const Placement& placement : placements(scene)) {
        out.resize(scene.meshes[static_cast<std::size_t>(placement.mesh)]
                       .primitives[static_cast<std::size_t>(placement.primitive)]
                       .positions.size());
        pose_positions(scene, pose, placement, out);
        vertices += out.size();
    }
    EXPECT_GT(vertices, 500000u);
    // 20 to 40 ms on one idle core; the rest is for busy machines and sanitizers.
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
}

}  // namespace
}  // namespace pentaprism
