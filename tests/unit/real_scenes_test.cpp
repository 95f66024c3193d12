// The readers on other people's files: known contents must arrive, broken files must end in an error or a scene, never
// in a crash.

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <pentaprism/error.h>
#include <pentaprism/scene.h>

#include "scene/pose.h"

namespace pentaprism {
namespace {

namespace fs = std::filesystem;

class RealScenes : public testing::Test {
  protected:
    void SetUp() override {
        const char* folder = std::getenv("PENTAPRISM_SCENES");
        if (folder == nullptr) GTEST_SKIP() << "PENTAPRISM_SCENES is not set";
        folder_ = folder;
    }
    Scene load(const std::string& file) const { return load_scene((folder_ / file).string()); }

    fs::path folder_;
};

struct Box {
    glm::dvec3 low{1e30}, high{-1e30};
};

Box bounds(const Scene& scene, double time) {
    const Pose pose = evaluate(scene, choose_animations(scene, "all"), time);
    Box box;
    for (const Placement& placement : placements(scene)) {
        std::vector<glm::dvec3> points(scene.meshes[static_cast<std::size_t>(placement.mesh)]
                                           .primitives[static_cast<std::size_t>(placement.primitive)]
                                           .positions.size());
        pose_positions(scene, pose, placement, points);
        for (const glm::dvec3& point : points) {
            box.low = glm::min(box.low, point);
            box.high = glm::max(box.high, point);
        }
    }
    return box;
}

void expect_same_bounds(const Scene& a, const Scene& b, double time, double tolerance) {
    const Box box_a = bounds(a, time), box_b = bounds(b, time);
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(box_a.low[k], box_b.low[k], tolerance);
        EXPECT_NEAR(box_a.high[k], box_b.high[k], tolerance);
    }
}

TEST_F(RealScenes, HaveTheirPublishedNumberOfTriangles) {
    // The scenes' own README, but for two rows: it counts all scenes of MultipleScenes and one of SimpleInstancing's
    // 125 cubes.
    const std::pair<const char*, std::int64_t> expected[] = {
        {"characters/kaykit-knight/Knight.glb", 6952},
        {"compression/apartment-meshopt/dream-apartment.glb", 177934},
        {"compression/gltf-transform/BoxDraco.gltf", 12},
        {"compression/gltf-transform/BoxMeshopt.glb", 12},
        {"compression/gltf-transform/BoxMeshopt.gltf", 12},
        {"compression/gltf-transform/DracoSparseMesh.gltf", 102},
        {"environment/apartment.glb", 187066},
        {"forest/forest.glb", 171807},
        {"hand/hand.glb", 15000},
        {"insects/insects.glb", 84846},
        {"khronos/AlphaBlendModeTest/AlphaBlendModeTest.glb", 61},
        {"khronos/BoxInterleaved/BoxInterleaved.glb", 12},
        {"khronos/Box_With_Spaces/Box With Spaces.gltf", 12},
        {"khronos/CesiumMan/CesiumMan.glb", 4672},
        {"khronos/CesiumMilkTruck/glTF-Binary/CesiumMilkTruck.glb", 3624},
        {"khronos/CesiumMilkTruck/glTF-Draco/CesiumMilkTruck.gltf", 3624},
        {"khronos/Fox/Fox.glb", 576},
        {"khronos/InterpolationTest/InterpolationTest.glb", 110},
        {"khronos/MeshPrimitiveModes/MeshPrimitiveModes.gltf", 16},
        {"khronos/MorphStressTest/MorphStressTest.glb", 2412},
        {"khronos/MultipleScenes/MultipleScenes.gltf", 2},
        {"khronos/NegativeScaleTest/NegativeScaleTest.glb", 7724},
        {"khronos/RecursiveSkeletons/RecursiveSkeletons.glb", 6384},
        {"khronos/RiggedFigure/glTF-Draco/RiggedFigure.gltf", 256},
        {"khronos/SimpleInstancing/SimpleInstancing.glb", 125 * 12},
        {"khronos/SimpleSparseAccessor/SimpleSparseAccessor.gltf", 12},
        {"khronos/TextureSettingsTest/TextureSettingsTest.glb", 72},
        {"khronos/TriangleWithoutIndices/TriangleWithoutIndices.gltf", 1},
        {"khronos/VertexColorTest/VertexColorTest.glb", 36},
        {"race/race.glb", 53887},
        {"torcs/torcs-race.glb", 54346},
    };
    for (const auto& [file, triangles] : expected) EXPECT_EQ(count_triangles(load(file)), triangles) << file;
}

TEST_F(RealScenes, ReadTheSameCompressedAsPlain) {
    const Scene plain_truck = load("khronos/CesiumMilkTruck/glTF-Binary/CesiumMilkTruck.glb");
    const Scene draco_truck = load("khronos/CesiumMilkTruck/glTF-Draco/CesiumMilkTruck.gltf");
    expect_same_bounds(plain_truck, draco_truck, 0.5, 2e-3);
    const Scene plain_figure = load("khronos/RiggedFigure/glTF-Binary/RiggedFigure.glb");
    const Scene draco_figure = load("khronos/RiggedFigure/glTF-Draco/RiggedFigure.gltf");
    for (const double time : {0.0, 0.4, 1.1}) expect_same_bounds(plain_figure, draco_figure, time, 2e-3);
    expect_same_bounds(load("parts/apartment/apartment.glb"), load("compression/apartment-meshopt/dream-apartment.glb"),
                       0.0, 2e-3);
    const Scene draco_box = load("compression/gltf-transform/BoxDraco.gltf"),
                meshopt_box = load("compression/gltf-transform/BoxMeshopt.glb");
    expect_same_bounds(draco_box, meshopt_box, 0.0, 1e-3);
    expect_same_bounds(draco_box, load("compression/gltf-transform/BoxMeshopt.gltf"), 0.0, 1e-3);
}

TEST_F(RealScenes, MorphQuantisedAsPlain) {
    const Scene plain = load("khronos/AnimatedMorphCube/glTF-Binary/AnimatedMorphCube.glb");
    const Scene quantised = load("khronos/AnimatedMorphCube/glTF-Quantized/AnimatedMorphCube.gltf");
    ASSERT_TRUE(plain.warnings.empty());
    ASSERT_TRUE(quantised.warnings.empty());
    // The quantised file keeps morph weights as bytes: half a step of 1/255 for each of two targets that move by 2 at
    // most.
    for (const double time : {0.0, 0.5, 1.0, 2.0, 3.0, 4.0})
        expect_same_bounds(plain, quantised, time, 2 * 2.0 * 0.5 / 255);
}

TEST_F(RealScenes, HaveCamerasOfBothKinds) {
    const Scene scene = load("khronos/Cameras/Cameras.gltf");
    ASSERT_EQ(scene.cameras.size(), 2u);
    EXPECT_TRUE(scene.cameras[0].perspective);
    EXPECT_DOUBLE_EQ(scene.cameras[0].yfov, 0.7);
    EXPECT_DOUBLE_EQ(scene.cameras[0].znear, 0.01);
    EXPECT_FALSE(scene.cameras[1].perspective);
    EXPECT_DOUBLE_EQ(scene.cameras[1].xmag, 1.0);
    EXPECT_EQ(scene.nodes[2].camera, 1);
}

TEST_F(RealScenes, MirroredNodesAreKnownAsSuch) {
    const Scene scene = load("khronos/NegativeScaleTest/NegativeScaleTest.glb");
    const Pose pose = evaluate(scene, {}, 0.0);
    int mirrored = 0;
    for (const Placement& placement : placements(scene)) mirrored += is_mirrored(scene, pose, placement);
    EXPECT_GT(mirrored, 0);
    EXPECT_LT(mirrored, static_cast<int>(placements(scene).size()));
}

/// The file's path relative to the scenes, and whether it must be refused or read
/// (tests/unit/malformed_expectations.json).
TEST_F(RealScenes, BrokenFilesEndAsExpectedAndSoon) {
    std::ifstream stream(fs::path(PENTAPRISM_SOURCE_DIR) / "tests/unit/malformed_expectations.json");
    const auto expectations = nlohmann::json::parse(stream);
    ASSERT_GT(expectations.size(), 300u);
    for (const auto& [file, expected] : expectations.items()) {
        const auto start = std::chrono::steady_clock::now();
        std::string outcome = "loads", message;
        try {
            const Scene scene = load(file);
            for (const std::string& warning : scene.warnings)
                EXPECT_EQ(warning.find('\n'), std::string::npos) << warning;
            bounds(scene, 0.5);
        } catch (const Error& error) {
            outcome = "error";
            message = error.what();
            EXPECT_EQ(error.kind(), ErrorKind::kScene);
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
            EXPECT_EQ(message.rfind(fs::path(file).filename().string() + ": ", 0), 0u) << message;
        }
        EXPECT_EQ(outcome, expected.get<std::string>()) << file << " " << message;
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10)) << file;
    }
}

TEST_F(RealScenes, NoBrokenFileIsWithoutAnExpectation) {
    std::ifstream stream(fs::path(PENTAPRISM_SOURCE_DIR) / "tests/unit/malformed_expectations.json");
    const auto expectations = nlohmann::json::parse(stream);
    for (const char* top : {"malformed", "khronos-generator", "obj"}) {
        for (const auto& entry : fs::recursive_directory_iterator(folder_ / top)) {
            const std::string suffix = entry.path().extension().string();
            if (suffix != ".gltf" && suffix != ".glb" && suffix != ".obj") continue;
            EXPECT_TRUE(expectations.contains(fs::relative(entry.path(), folder_).generic_string())) << entry.path();
        }
    }
}

}  // namespace
}  // namespace pentaprism
