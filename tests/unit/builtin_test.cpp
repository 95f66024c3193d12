#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>
#include <iterator>
#include <map>
#include <pentaprism/error.h>
#include <pentaprism/scene.h>
#include <set>

#include "scene/builtin/assembly.h"
#include "scene/builtin/implicit.h"
#include "scene/builtin/mesh_builder.h"
#include "scene/builtin/random.h"
#include "scene/pose.h"

namespace pentaprism {
namespace {

class Builtin : public testing::TestWithParam<std::string> {
  protected:
    // Made once for all tests of one scene.
    static const Scene& made(const std::string& name) {
        static std::map<std::string, Scene> scenes;
        auto found = scenes.find(name);
        if (found == scenes.end()) found = scenes.emplace(name, make_builtin_scene(name)).first;
        return found->second;
    }
    const Scene& scene_ = made(GetParam());
};

std::vector<std::string> names() {
    std::vector<std::string> list;
    for (const BuiltinScene& scene : builtin_scenes()) list.emplace_back(scene.name);
    return list;
}

INSTANTIATE_TEST_SUITE_P(Scenes, Builtin, testing::ValuesIn(names()), [](const auto& info) {
    std::string name = info.param;
    std::erase(name, '-');
    return name;
});

template <class Check>
void for_each_primitive(const Scene& scene, const Check& check) {
    for (const Mesh& mesh : scene.meshes)
        for (const Primitive& primitive : mesh.primitives) check(mesh.name, primitive);
}

std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

TEST(BuiltinScenes, AnUnknownNameIsRefusedWithTheNamesThatThereAre) {
    try {
        make_builtin_scene("fairy-garden");
        FAIL() << "no exception";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kScene);
        EXPECT_NE(std::string(error.what()).find("fairy-forest"), std::string::npos) << error.what();
    }
}

TEST_P(Builtin, HasTheNumberOfTrianglesOfItsNameWithinThreePercent) {
    for (const BuiltinScene& listed : builtin_scenes()) {
        if (listed.name != GetParam()) continue;
        const auto wanted = static_cast<double>(listed.triangles), tolerance = 0.03 * wanted;
        EXPECT_NEAR(static_cast<double>(count_triangles(scene_)), wanted, tolerance);
    }
}

TEST_P(Builtin, GivesTheSameBytesTwice) {
    const std::filesystem::path folder = testing::TempDir();
    const auto first = folder / (GetParam() + "-first.glb"), second = folder / (GetParam() + "-second.glb");
    write_glb(scene_, first);
    write_glb(make_builtin_scene(GetParam()), second);
    EXPECT_EQ(bytes_of(first), bytes_of(second));
    std::filesystem::remove(first);
    std::filesystem::remove(second);
}

TEST_P(Builtin, HasFinitePositionsUnitNormalsAndIndicesInRange) {
    for_each_primitive(scene_, [](const std::string& mesh, const Primitive& primitive) {
        SCOPED_TRACE(mesh);
        const std::size_t n = primitive.positions.size();
        ASSERT_EQ(primitive.normals.size(), n);
        EXPECT_EQ(primitive.indices.size() % 3, 0u);
        EXPECT_FALSE(primitive.indices.empty());
        std::size_t out_of_range = 0, not_finite = 0, not_unit = 0;
        for (const std::uint32_t index : primitive.indices) out_of_range += index >= n;
        for (const glm::vec3& p : primitive.positions) not_finite += !std::isfinite(p.x + p.y + p.z);
        for (const glm::vec3& normal : primitive.normals) not_unit += !(std::abs(glm::length(normal) - 1.0f) < 1e-4f);
        EXPECT_EQ(out_of_range, 0u);
        EXPECT_EQ(not_finite, 0u);
        EXPECT_EQ(not_unit, 0u);
    });
}

TEST_P(Builtin, HasNoTriangleWithTwoCornersInOnePlace) {
    for_each_primitive(scene_, [](const std::string& mesh, const Primitive& primitive) {
        std::size_t degenerate = 0;
        for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
            const glm::vec3 a = primitive.positions[primitive.indices[i]],
                            b = primitive.positions[primitive.indices[i + 1]],
                            c = primitive.positions[primitive.indices[i + 2]];
            degenerate += a == b || b == c || c == a;
        }
        EXPECT_EQ(degenerate, 0u) << mesh;
    });
}

TEST_P(Builtin, HasSkinWeightsThatSumToOne) {
    for_each_primitive(scene_, [](const std::string& mesh, const Primitive& primitive) {
        const auto per_vertex = static_cast<std::size_t>(primitive.influences);
        ASSERT_EQ(primitive.weights.size(), per_vertex * primitive.positions.size()) << mesh;
        for (std::size_t i = 0; per_vertex > 0 && i < primitive.weights.size(); i += per_vertex) {
            float sum = 0.0f;
            for (std::size_t k = 0; k < per_vertex; ++k) sum += primitive.weights[i + k];
            ASSERT_NEAR(sum, 1.0f, 1e-5f) << mesh << ", vertex " << i / per_vertex;
        }
    });
}

TEST_P(Builtin, MovesInItsFirstFrameAndInItsTwentyFourth) {
    const std::vector<Index> clips = choose_animations(scene_, "all");
    for (const double frame : {0.0, 24.0}) {
        const Pose open = evaluate(scene_, clips, frame / 24.0), close = evaluate(scene_, clips, (frame + 0.25) / 24.0);
        std::size_t moving = 0;
        for (std::size_t i = 0; i < scene_.nodes.size(); ++i)
            moving += scene_.nodes[i].mesh != kNone && open.world[i] != close.world[i];
        if (!scene_.skins.empty())
            for (const Index joint : scene_.skins[0].joints)
                moving += open.world[std::size_t(joint)] != close.world[std::size_t(joint)];
        EXPECT_GE(moving, 4u) << "frame " << frame;
    }
}

TEST_P(Builtin, HasACameraThatMovesAndALensThatBlurs) {
    ASSERT_FALSE(scene_.cameras.empty());
    const LensInfo& lens = scene_.cameras[0].lens;
    EXPECT_TRUE(lens.fstop && lens.focus_distance && lens.focal_length_mm && lens.sensor_width_mm && lens.shutter);
    const std::vector<Index> clips = choose_animations(scene_, "all");
    for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
        if (scene_.nodes[i].camera != 0) continue;
        EXPECT_NE(evaluate(scene_, clips, 0.0).world[i], evaluate(scene_, clips, 0.5).world[i]);
    }
}

TEST_P(Builtin, PaintsWithVertexColoursBetweenZeroAndOne) {
    for_each_primitive(scene_, [](const std::string& mesh, const Primitive& primitive) {
        std::size_t outside = 0;
        for (const glm::vec4& c : primitive.colors)
            for (int k = 0; k < 4; ++k) outside += !(c[k] >= 0.0f && c[k] <= 1.0f);
        EXPECT_EQ(outside, 0u) << mesh;
    });
}

TEST_P(Builtin, KeepsItsTexturesSmall) {
    for (const Image& image : scene_.images) {
        EXPECT_LE(std::max(image.width, image.height), 512) << image.name;
        EXPECT_EQ(image.texels.size(), std::size_t(4) * std::size_t(image.width) * std::size_t(image.height))
            << image.name;
    }
}

TEST(BuiltinShapes, AnEllipsoidFacesOutwardsEverywhere) {
    builtin::MeshBuilder builder;
    builder.ellipsoid(glm::dvec3(0.0), {1.0, 2.0, 0.5}, 12, 8);
    const Primitive mesh = builder.take(kNone);
    EXPECT_EQ(mesh.indices.size() / 3, 12u * 2u * 7u);
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const glm::vec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                        c = mesh.positions[mesh.indices[i + 2]];
        EXPECT_GT(glm::dot(glm::cross(b - a, c - a), a + b + c), 0.0f);
        EXPECT_GT(glm::dot(mesh.normals[mesh.indices[i]], a), 0.0f);
    }
}

TEST(BuiltinShapes, ABladeOfNSegmentsHasFourTimesNMinusOneTriangles) {
    builtin::MeshBuilder builder;
    builder.blade({glm::dvec3(0.0), {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, 2.0, 0.5, 0.7, 0.2, 0.4, 5});
    EXPECT_EQ(builder.take(kNone).indices.size() / 3, 16u);
}

TEST(BuiltinShapes, AnImplicitBodyIsAClosedSurfaceOnItsZeroSet) {
    using builtin::Limb;
    const builtin::ImplicitBody body(
        {Limb{{0.0, 0.0, 0.0}, {0.0, 3.0, 0.0}, 1.0, 0.6}, Limb{{0.0, 2.0, 0.0}, {2.0, 3.0, 0.0}, 0.5, 0.3}}, 0.4);
    const Primitive mesh = body.polygonize(0.2, kNone, false);
    for (const glm::vec3& p : mesh.positions) EXPECT_NEAR(body.distance(glm::dvec3(p)), 0.0, 0.01);
    // Closed and oriented: every edge is walked once in each direction.
    std::multiset<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
        for (std::size_t k = 0; k < 3; ++k) edges.emplace(mesh.indices[i + k], mesh.indices[i + (k + 1) % 3]);
    for (const auto& [a, b] : edges) ASSERT_EQ(edges.count({b, a}), edges.count({a, b}));
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const glm::vec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                        c = mesh.positions[mesh.indices[i + 2]];
        EXPECT_GE(glm::dot(glm::cross(b - a, c - a), mesh.normals[mesh.indices[i]]), 0.0f);
    }
}

TEST(BuiltinRandom, IsTheGeneratorOfItsPaper) {
    // The same recurrence and output permutation, written from the paper's formulas in another way.
    builtin::Random random(12345);
    std::uint64_t state = 12345ull * 2 + 1;
    const auto reference = [&state] {
        const std::uint64_t s = state;
        state = s * 6364136223846793005ull + 1442695040888963407ull;
        const std::uint32_t x = static_cast<std::uint32_t>((s ^ (s >> 18)) >> 27);
        const int r = static_cast<int>(s >> 59);
        return r == 0 ? x : (x >> r) | (x << (32 - r));
    };
    reference(), reference();
    for (int i = 0; i < 100; ++i) ASSERT_EQ(random.next(), reference());
}

TEST(BuiltinAssembly, LookingTurnsTheMinusZAxisTowardsTheTarget) {
    const glm::dvec3 eye{1.0, 2.0, 3.0}, target{-4.0, 0.5, 1.0};
    const glm::dvec3 forward = builtin::looking(eye, target) * glm::dvec3(0.0, 0.0, -1.0);
    EXPECT_NEAR(glm::length(forward - glm::normalize(target - eye)), 0.0, 1e-12);
}

}  // namespace
}  // namespace pentaprism
