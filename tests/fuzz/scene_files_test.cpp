// Damaged scene files: whatever is done to a good file, loading it ends in a scene that can be posed or in an Error of
// one line.

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <pentaprism/error.h>
#include <pentaprism/scene.h>

#include "scene/pose.h"
#include "unit/gltf_file.h"

namespace pentaprism {
namespace {

using nlohmann::json;

/// The same numbers on every machine (xorshift64*, Vigna 2016).
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15u + 1) {}
    std::size_t below(std::size_t n) {
        state_ ^= state_ >> 12;
        state_ ^= state_ << 25;
        state_ ^= state_ >> 27;
        return static_cast<std::size_t>((state_ * 0x2545F4914F6CDD1Du) >> 33) % n;
    }

  private:
    std::uint64_t state_;
};

void load_and_pose(const std::filesystem::path& file) {
    try {
        const Scene scene = load_scene(file.string());
        const Pose pose = evaluate(scene, choose_animations(scene, "all"), 0.5);
        for (const Placement& placement : placements(scene)) {
            const Primitive& primitive = scene.meshes[static_cast<std::size_t>(placement.mesh)]
                                             .primitives[static_cast<std::size_t>(placement.primitive)];
            std::vector<glm::dvec3> positions(primitive.positions.size());
            std::vector<glm::vec3> normals(primitive.positions.size());
            pose_positions(scene, pose, placement, positions);
            pose_normals(scene, pose, placement, normals);
            for (const std::uint32_t index : primitive.indices) ASSERT_LT(index, primitive.positions.size());
            ASSERT_EQ(primitive.normals.size(), primitive.positions.size());
        }
    } catch (const Error& error) {
        ASSERT_EQ(error.kind(), ErrorKind::kScene);
        ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
}

/// A skinned, morphed, animated, textured, instanced, lit triangle: something of everything.
void fill(test::GltfFile& file) {
    const int positions = file.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0}),
              normals = file.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
    json& primitive = file.mesh({{"POSITION", positions},
                                 {"NORMAL", normals},
                                 {"TEXCOORD_0", file.floats("VEC2", {0, 0, 1, 0, 0, 1})},
                                 {"COLOR_0", file.floats("VEC3", {1, 1, 1, 1, 1, 1, 1, 1, 1})},
                                 {"JOINTS_0", file.bytes("VEC4", {0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0})},
                                 {"WEIGHTS_0", file.floats("VEC4", {1, 0, 0, 0, 0, 1, 0, 0, 0.5f, 0.5f, 0, 0})}});
    primitive["indices"] = file.shorts("SCALAR", {0, 1, 2});
    primitive["material"] = 0;
    primitive["targets"] = json::array({{{"POSITION", normals}, {"NORMAL", normals}}});
    const std::vector<float> identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    std::vector<float> two = identity;
    two.insert(two.end(), identity.begin(), identity.end());
    const int matrices = file.floats("MAT4", two), times = file.floats("SCALAR", {0, 1}),
              turns = file.floats("VEC4", {0, 0, 0, 1, 0, 1, 0, 0});
    const int weights = file.floats("SCALAR", {0, 1}), indices = file.view(std::vector<std::uint16_t>{1});
    file.json["accessors"][positions]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
        {"values", {{"bufferView", file.view(std::vector<float>{1, 0, 0})}}}};
    file.json["materials"] = json::array(
        {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"baseColorFactor", {1, 1, 1, 1}}}}}});
    file.json["textures"] = json::array({{{"source", 0}, {"sampler", 0}}});
    file.json["samplers"] = json::array({{{"wrapS", 10497}}});
    file.json["images"] = json::array(
        {{{"uri",
           "data:image/"
           "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg="
           "="}}});
    file.json["cameras"] = json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}});
    file.json["skins"] = json::array({{{"joints", {1, 2}}, {"inverseBindMatrices", matrices}}});
    file.json["extensions"]["KHR_lights_punctual"]["lights"] =
        json::array({{{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}}}}});
    const json instancing = {{"attributes", {{"TRANSLATION", positions}}}};
    file.json["nodes"] = json::array(
        {{{"mesh", 0}, {"skin", 0}, {"weights", {0.5}}},
         {{"children", {2, 3}}, {"translation", {1, 2, 3}}},
         {{"rotation", {0, 0, 0, 1}}, {"camera", 0}},
         {{"mesh", 0},
          {"scale", {1, 2, 1}},
          {"extensions", {{"EXT_mesh_gpu_instancing", instancing}, {"KHR_lights_punctual", {{"light", 0}}}}}}});
    file.json["scenes"] = json::array({{{"nodes", {0, 1}}}});
    file.json["scene"] = 0;
    file.json["animations"] = json::array(
        {{{"samplers", json::array({{{"input", times}, {"output", turns}}, {{"input", times}, {"output", weights}}})},
          {"channels", json::array({{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}},
                                    {{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}}})}}});
}

void collect(const json& value, const json::json_pointer& place, std::vector<json::json_pointer>& places) {
    if (!place.empty()) places.push_back(place);
    if (value.is_object()) {
        for (const auto& [key, member] : value.items()) collect(member, place / key, places);
    } else if (value.is_array()) {
        for (std::size_t i = 0; i < value.size(); ++i) collect(value[i], place / i, places);
    }
}

TEST(DamagedFiles, EveryMemberOfAGltfMayBeWrong) {
    test::TemporaryFolder folder;
    test::GltfFile file;
    fill(file);
    const auto good = file.save(folder);
    ASSERT_EQ(count_triangles(load_scene(good.string())), 4);
    std::vector<json::json_pointer> places;
    collect(file.json, json::json_pointer(), places);
    ASSERT_GT(places.size(), 200u);
    const json replacements[] = {
        -1,  0,      1,    7,       65536,         4294967295u,    18446744073709551615u, 1e300,
        0.5, "text", true, nullptr, json::array(), json::object(), json::array({0, 1})};
    for (const auto& place : places) {
        for (const json& replacement : replacements) {
            json damaged = file.json;
            damaged[place] = replacement;
            SCOPED_TRACE(place.to_string() + " = " + replacement.dump());
            ASSERT_NO_FATAL_FAILURE(load_and_pose(folder.write("test.gltf", damaged.dump())));
        }
        json damaged = file.json;
        damaged[place.parent_pointer()].is_object() ? void(damaged[place.parent_pointer()].erase(place.back()))
                                                    : damaged[place.parent_pointer()].erase(std::stoul(place.back()));
        SCOPED_TRACE(place.to_string() + " left out");
        ASSERT_NO_FATAL_FAILURE(load_and_pose(folder.write("test.gltf", damaged.dump())));
    }
}

/// Random bytes of real files are changed, or the files are cut.
TEST(DamagedFiles, EveryByteOfARealFileMayBeWrong) {
    const char* scenes = std::getenv("PENTAPRISM_SCENES");
    if (scenes == nullptr) GTEST_SKIP() << "PENTAPRISM_SCENES is not set";
    test::TemporaryFolder folder;
    for (const char* name :
         {"compression/gltf-transform/BoxMeshopt.glb", "compression/gltf-transform/BoxMeshopt.bin",
          "compression/gltf-transform/DracoSparseMesh.bin",
          "khronos/AnimatedMorphCube/glTF-Binary/AnimatedMorphCube.glb",
          "khronos/RiggedFigure/glTF-Binary/RiggedFigure.glb", "khronos/SimpleInstancing/SimpleInstancing.glb",
          "obj/assimp/OBJ/box.obj", "obj/obj2gltf/concave/concave.obj"}) {
        const std::filesystem::path original = std::filesystem::path(scenes) / name;
        ASSERT_TRUE(std::filesystem::exists(original)) << original;
        // A damaged .bin is read through the .gltf beside it.
        const bool part = original.extension() == ".bin";
        const std::filesystem::path main = part ? std::filesystem::path(original).replace_extension(".gltf") : original;
        if (part)
            std::filesystem::copy_file(main, folder.path() / main.filename(),
                                       std::filesystem::copy_options::overwrite_existing);
        std::ifstream stream(original, std::ios::binary);
        const std::string good{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
        for (std::uint64_t seed = 0; seed < 60; ++seed) {
            Random random(seed);
            std::string damaged = good;
            const std::size_t changes = 1 + random.below(8);
            for (std::size_t i = 0; i < changes; ++i)
                damaged[random.below(damaged.size())] = static_cast<char>(random.below(256));
            if (random.below(4) == 0) damaged.resize(random.below(damaged.size()));
            folder.write(original.filename().string(), damaged);
            SCOPED_TRACE(std::string(name) + ", seed " + std::to_string(seed));
            ASSERT_NO_FATAL_FAILURE(load_and_pose(folder.path() / main.filename()));
        }
    }
}

}  // namespace
}  // namespace pentaprism
