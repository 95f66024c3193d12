#include "scene/tangents.h"

#include <cstdlib>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "small_scene.h"

namespace pentaprism {
namespace {

TEST(Tangents, ASquareHasTheTangentOfItsUAndABitangentThatRunsUpInThePicture) {
    const Primitive square = small_scene::square(1.0f, 0.0f, 0);  // u to +x, v down along -y
    for (const glm::vec4& t : make_tangents(square, 0)) {
        EXPECT_NEAR(t.x, 1.0f, 1e-6f);
        const glm::vec3 bitangent = glm::cross(glm::vec3(0, 0, 1), glm::vec3(t)) * t.w;
        EXPECT_NEAR(bitangent.y, 1.0f, 1e-6f);
    }
    Primitive mirrored = square;
    for (glm::vec2& uv : mirrored.texcoords[0]) uv.x = 1.0f - uv.x;
    for (const glm::vec4& t : make_tangents(mirrored, 0)) {
        EXPECT_NEAR(t.x, -1.0f, 1e-6f);
        const glm::vec3 bitangent = glm::cross(glm::vec3(0, 0, 1), glm::vec3(t)) * t.w;
        EXPECT_NEAR(bitangent.y, 1.0f, 1e-6f);
    }
}

TEST(Tangents, WithoutTextureCoordinatesThereAreNone) {
    Primitive bare = small_scene::square(1.0f, 0.0f, 0);
    bare.texcoords[0].clear();
    EXPECT_TRUE(make_tangents(bare, 0).empty());
}

TEST(Tangents, AreThoseThatAnAuthorsToolStored) {
    const char* scenes = std::getenv("PENTAPRISM_SCENES");
    if (!scenes) GTEST_SKIP() << "PENTAPRISM_SCENES is not set";
    const Scene scene =
        load_scene(std::string(scenes) + "/khronos/NormalTangentMirrorTest/NormalTangentMirrorTest.glb");
    std::size_t compared = 0, alike = 0, same_side = 0;
    for (const Mesh& mesh : scene.meshes)
        for (const Primitive& primitive : mesh.primitives) {
            if (primitive.tangents.empty()) continue;
            const std::vector<glm::vec4> made = make_tangents(primitive, 0);
            for (std::size_t i = 0; i < made.size(); ++i) {
                ++compared;
                alike += glm::dot(glm::vec3(made[i]), glm::vec3(primitive.tangents[i])) > 0.98f;
                same_side += made[i].w == primitive.tangents[i].w;
            }
        }
    ASSERT_GT(compared, 1000u);
    EXPECT_GT(static_cast<double>(alike) / static_cast<double>(compared), 0.97);
    EXPECT_GT(static_cast<double>(same_side) / static_cast<double>(compared), 0.99);
}

}  // namespace
}  // namespace pentaprism
