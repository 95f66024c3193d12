// OBJ and MTL files whose contents are known.

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <pentaprism/error.h>
#include <pentaprism/scene.h>
#include <unistd.h>

#include "scene/polygon.h"
#include "unit/gltf_file.h"

namespace pentaprism {
namespace {

class ObjReader : public testing::Test {
  protected:
    Scene load(const std::string& text) { return load_scene(folder.write("test.obj", text).string()); }
    std::string refusal(const std::string& text) {
        try {
            load(text);
            return "";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::kScene);
            return error.what();
        }
    }
    test::TemporaryFolder folder;
};

constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(ObjReader, PolygonsAreCutAndNormalsMade) {
    const Scene scene = load(std::string(kSquare) + "f 1 2 3 4\n");
    EXPECT_EQ(count_triangles(scene), 2);
    for (const glm::vec3& normal : scene.meshes[0].primitives[0].normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1));
}

TEST_F(ObjReader, MissingNormalsAreSmoothAcrossFaces) {
    // A roof: both slopes meet at x = 0.
    const Scene scene = load("v -1 0 0\nv 0 1 0\nv 0 1 1\nv 1 0 0\nf 1 3 2\nf 4 2 3\n");
    const Primitive& primitive = scene.meshes[0].primitives[0];
    for (std::size_t i = 0; i < primitive.positions.size(); ++i) {
        if (primitive.positions[i].x == 0.0f) {
            EXPECT_NEAR(primitive.normals[i].y, 1.0f, 1e-6f);
        }
    }
}

TEST_F(ObjReader, NegativeIndicesCountBack) {
    const Scene scene = load(std::string(kSquare) + "f -4 -3 -2\nv 9 9 9\n");
    EXPECT_EQ(scene.meshes[0].primitives[0].positions[0], glm::vec3(0, 0, 0));
    EXPECT_EQ(scene.meshes[0].primitives[0].positions[2], glm::vec3(1, 1, 0));
}

TEST_F(ObjReader, VerticesThatDoNotExistAreRefused) {
    EXPECT_EQ(refusal(std::string(kSquare) + "f 1 2 3\nf 1 2 5\n"), "test.obj: face 2 refers to vertex 5 of 4");
    EXPECT_EQ(refusal(std::string(kSquare) + "f 0 1 2\n"), "test.obj: face 1 refers to vertex 0; the first is 1");
    EXPECT_EQ(refusal(std::string(kSquare) + "f -5 1 2\n"),
              "test.obj: face 1 refers to vertex -5, but only 4 come before it");
    EXPECT_EQ(refusal("vt 0 0\n" + std::string(kSquare) + "f 1/1 2/2 3/1\n"),
              "test.obj: face 1 refers to texture coordinate 2 of 1");
}

TEST_F(ObjReader, TextureCoordinatesCountDownwards) {
    const Scene scene = load(std::string(kSquare) + "vt 0.25 0.125\nf 1/1 2/1 3/1\n");
    EXPECT_EQ(scene.meshes[0].primitives[0].texcoords[0][0], glm::vec2(0.25f, 0.875f));
}

TEST_F(ObjReader, MaterialsHaveNamesWithSpaces) {
    folder.write("my colours.mtl", "newmtl dark red\nKd 0.5 0 0\nKe 1 2 3\nPr 0.25\nPm 0.75\nd 0.5\n");
    const Scene scene = load("mtllib my colours.mtl\n" + std::string(kSquare) + "usemtl dark red \nf 1 2 3\n");
    EXPECT_TRUE(scene.warnings.empty());
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.meshes[0].primitives[0].material, 0);
    const Material& material = scene.materials[0];
    EXPECT_EQ(material.base_color, glm::vec4(0.5f, 0.0f, 0.0f, 0.5f));
    EXPECT_EQ(material.alpha_mode, AlphaMode::kBlend);
    EXPECT_EQ(material.emissive, glm::vec3(1, 2, 3));
    EXPECT_EQ(material.roughness, 0.25f);
    EXPECT_EQ(material.metallic, 0.75f);
}

TEST_F(ObjReader, AMissingLibraryIsAWarning) {
    const Scene scene = load("mtllib none.mtl\n" + std::string(kSquare) + "usemtl red\nf 1 2 3\n");
    EXPECT_EQ(scene.warnings.size(), 2u);
    EXPECT_EQ(scene.meshes[0].primitives[0].material, kNone);
    EXPECT_EQ(count_triangles(scene), 1);
}

TEST_F(ObjReader, ObjectsBecomeNodesAndMaterialsPrimitives) {
    folder.write("two.mtl", "newmtl a\nnewmtl b\n");
    const Scene scene =
        load("mtllib two.mtl\n" + std::string(kSquare) +
             "o first one\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\nusemtl a\nf 1 2 4\no second\nf 2 3 4\n");
    ASSERT_EQ(scene.nodes.size(), 2u);
    EXPECT_EQ(scene.nodes[0].name, "first one");
    ASSERT_EQ(scene.meshes[0].primitives.size(), 2u);
    EXPECT_EQ(scene.meshes[0].primitives[0].indices.size(), 6u);
    EXPECT_EQ(scene.meshes[1].primitives.size(), 1u);
}

double area(const std::vector<glm::vec3>& corners) {
    glm::dvec3 sum(0.0);
    for (const auto& [a, b, c] : triangulate_polygon(corners)) {
        const glm::dvec3 twice = glm::cross(glm::dvec3(corners[b] - corners[a]), glm::dvec3(corners[c] - corners[a]));
        EXPECT_GE(twice.z, 0.0);
        sum += twice / 2.0;
    }
    return sum.z;
}

TEST(Polygon, ConcaveOnesAreCutWithoutOverlap) {
    // An L and an arrow head: no triangle may turn over, and the areas add up to the polygon's.
    EXPECT_DOUBLE_EQ(area({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}}), 3.0);
    EXPECT_DOUBLE_EQ(area({{0, 0, 0}, {2, -2, 0}, {1, 0, 0}, {2, 2, 0}}), 2.0);
}

TEST(Polygon, AlwaysGivesTwoFewerTrianglesThanCorners) {
    // A bow tie, a line, a point: nothing sensible to cut, but nothing may hang or be lost either.
    for (const std::vector<glm::vec3>& corners :
         {std::vector<glm::vec3>{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}},
          std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}},
          std::vector<glm::vec3>(7, glm::vec3(1, 2, 3))}) {
        EXPECT_EQ(triangulate_polygon(corners).size(), corners.size() - 2);
    }
    std::vector<glm::vec3> star;
    for (int i = 0; i < 600; ++i) {
        const float angle = static_cast<float>(i) * 0.0104719755f, radius = i % 2 == 0 ? 1.0f : 2.0f;
        star.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0f);
    }
    EXPECT_EQ(triangulate_polygon(star).size(), 598u);
}

}  // namespace
}  // namespace pentaprism
