// What the glTF reader makes of small files whose contents are known, and that it refuses broken ones in one clear
// line.

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <pentaprism/error.h>
#include <pentaprism/scene.h>
#include <unistd.h>

#include "scene/pose.h"
#include "unit/gltf_file.h"

namespace pentaprism {
namespace {

using nlohmann::json;
using test::GltfFile;
using test::TemporaryFolder;

class GltfReader : public testing::Test {
  protected:
    Scene load() { return load_scene(file.save(folder).string()); }

    /// The message of the error that loading ends with; empty if it does not.
    std::string refusal() {
        try {
            load();
            return "";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::kScene);
            return error.what();
        }
    }

    static testing::AssertionResult mentions(const std::vector<std::string>& warnings, const std::string& text) {
        for (const std::string& warning : warnings) {
            if (warning.find(text) != std::string::npos) return testing::AssertionSuccess();
        }
        return testing::AssertionFailure() << "no warning mentions \"" << text << '"';
    }

    TemporaryFolder folder;
    GltfFile file;
};

TEST_F(GltfReader, MissingNormalsAreFlatAndUnshareVertices) {
    auto& primitive = file.mesh({{"POSITION", file.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1})}});
    primitive["indices"] = file.bytes("SCALAR", {0, 1, 2, 0, 3, 1});
    file.node({{"mesh", 0}});
    const Scene scene = load();
    const Primitive& read = scene.meshes[0].primitives[0];
    ASSERT_EQ(read.positions.size(), 6u);
    EXPECT_EQ(read.normals[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(read.normals[3], glm::vec3(0, 1, 0));
    EXPECT_EQ(count_triangles(scene), 2);
}

TEST_F(GltfReader, StripsAndFansKeepTheFrontOfEveryTriangle) {
    const int square = file.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
    const int round = file.floats("VEC3", {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
    file.mesh({{"POSITION", square}})["mode"] = 5;
    file.mesh({{"POSITION", round}})["mode"] = 6;
    const Scene scene = load();
    for (const Mesh& mesh : scene.meshes) {
        ASSERT_EQ(mesh.primitives[0].indices.size(), 6u);
        for (const glm::vec3& normal : mesh.primitives[0].normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1));
    }
}

TEST_F(GltfReader, PointsAndLinesAreLeftOutWithAWarning) {
    file.triangle();
    file.json["meshes"][0]["primitives"][0]["mode"] = 1;
    const Scene scene = load();
    EXPECT_EQ(count_triangles(scene), 0);
    EXPECT_TRUE(mentions(scene.warnings, "points or lines"));
}

TEST_F(GltfReader, IndicesOfAllTypesReadAlike) {
    const int positions = file.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int normals = file.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
    for (const int indices :
         {file.bytes("SCALAR", {2, 0, 1}), file.shorts("SCALAR", {2, 0, 1}), file.words("SCALAR", {2, 0, 1})}) {
        file.mesh({{"POSITION", positions}, {"NORMAL", normals}})["indices"] = indices;
    }
    for (const Mesh& mesh : load().meshes) EXPECT_EQ(mesh.primitives[0].indices, (std::vector<std::uint32_t>{2, 0, 1}));
}

TEST_F(GltfReader, InterleavedAttributesAreTakenApart) {
    // Position and texture coordinate of each vertex in 20 bytes.
    const int view = file.view(std::vector<float>{0, 0, 0, 0.25f, 0.5f, 1, 0, 0, 0.5f, 0.5f, 0, 1, 0, 0.75f, 0.5f});
    file.json["bufferViews"][0]["byteStride"] = 20;
    file.json["accessors"] = json::array(
        {{{"bufferView", view}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}},
         {{"bufferView", view}, {"byteOffset", 12}, {"componentType", 5126}, {"count", 3}, {"type", "VEC2"}}});
    file.mesh({{"POSITION", 0}, {"TEXCOORD_0", 1}});
    const Primitive read = load().meshes[0].primitives[0];
    EXPECT_EQ(read.positions[2], glm::vec3(0, 1, 0));
    EXPECT_EQ(read.texcoords[0][2], glm::vec2(0.75f, 0.5f));
}

TEST_F(GltfReader, SparseValuesReplaceZerosWithoutABufferView) {
    const int indices = file.view(std::vector<std::uint16_t>{1, 2}),
              values = file.view(std::vector<float>{1, 0, 0, 0, 1, 0});
    file.json["accessors"].push_back({{"componentType", 5126},
                                      {"count", 3},
                                      {"type", "VEC3"},
                                      {"sparse",
                                       {{"count", 2},
                                        {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                        {"values", {{"bufferView", values}}}}}});
    file.mesh({{"POSITION", 0}});
    const Primitive read = load().meshes[0].primitives[0];
    EXPECT_EQ(read.positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST_F(GltfReader, NormalisedIntegersBecomeFractions) {
    file.triangle();
    const int colors = file.shorts("VEC3", {65535, 0, 13107, 0, 65535, 0, 0, 0, 65535});
    file.json["accessors"][colors]["normalized"] = true;
    file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = colors;
    const Primitive read = load().meshes[0].primitives[0];
    EXPECT_EQ(read.colors[0], glm::vec4(1.0f, 0.0f, 0.2f, 1.0f));
}

TEST_F(GltfReader, EightInfluencesAreScaledToASumOfOne) {
    file.triangle();
    auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = file.bytes("VEC4", {0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    attributes["JOINTS_1"] = file.bytes("VEC4", {1, 9, 9, 9, 0, 0, 0, 0, 0, 0, 0, 0});
    attributes["WEIGHTS_0"] = file.floats("VEC4", {1, 0.5f, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    attributes["WEIGHTS_1"] = file.floats("VEC4", {0.5f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    file.json["nodes"] = json::array({{{"mesh", 0}, {"skin", 0}}, json::object(), json::object()});
    file.json["skins"] = json::array({{{"joints", {1, 2}}}});
    const Scene scene = load();
    const Primitive& read = scene.meshes[0].primitives[0];
    EXPECT_EQ(read.influences, 8);
    EXPECT_EQ((std::vector<float>(read.weights.begin(), read.weights.begin() + 5)),
              (std::vector<float>{0.5f, 0.25f, 0, 0, 0.25f}));
    // Joint 9 does not exist but weighs nothing.
    EXPECT_EQ(read.joints[5], 0);
    EXPECT_TRUE(mentions(scene.warnings, "sum is not 1"));
}

TEST_F(GltfReader, AJointBeyondTheSkinIsRefused) {
    file.triangle();
    auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = file.bytes("VEC4", {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    attributes["WEIGHTS_0"] = file.floats("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    file.json["nodes"] = json::array({{{"mesh", 0}, {"skin", 0}}, json::object()});
    file.json["skins"] = json::array({{{"joints", {1}}}});
    EXPECT_EQ(refusal(), "test.gltf: node 0: mesh 0 names joint 1, but skin 0 has 1");
}

TEST_F(GltfReader, VerticesThatNoTriangleNamesAreDropped) {
    auto& primitive = file.mesh({{"POSITION", file.floats("VEC3", {9, 9, 9, 0, 0, 0, 1, 0, 0, 8, 8, 8, 0, 1, 0})},
                                 {"NORMAL", file.floats("VEC3", {1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1})}});
    primitive["indices"] = file.bytes("SCALAR", {1, 2, 4});
    const Primitive read = load().meshes[0].primitives[0];
    EXPECT_EQ(read.positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(read.indices, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST_F(GltfReader, MaterialExtensionsArrive) {
    file.json["materials"] = json::array({{{"emissiveFactor", {0.5, 0.25, 0}},
                                           {"alphaMode", "MASK"},
                                           {"alphaCutoff", 0.25},
                                           {"doubleSided", true},
                                           {"extensions",
                                            {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}},
                                             {"KHR_materials_unlit", json::object()}}}}});
    const Material material = load().materials[0];
    EXPECT_EQ(material.emissive, glm::vec3(4.0f, 2.0f, 0.0f));
    EXPECT_EQ(material.alpha_mode, AlphaMode::kMask);
    EXPECT_EQ(material.alpha_cutoff, 0.25f);
    EXPECT_TRUE(material.double_sided);
    EXPECT_TRUE(material.unlit);
}

TEST_F(GltfReader, AMissingImageCostsOneWarningAndTheTexture) {
    file.json["images"] = json::array({{{"uri", "nothing%20here.png"}}});
    file.json["textures"] = json::array({{{"source", 0}}});
    const json used = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}};
    file.json["materials"] = json::array({used, used});
    const Scene scene = load();
    EXPECT_EQ(scene.warnings.size(), 1u);
    EXPECT_TRUE(mentions(scene.warnings, "nothing%20here.png"));
    EXPECT_EQ(scene.materials[1].base_color_texture.image, kNone);
}

TEST_F(GltfReader, TextureTransformsOverrideTheCoordinateSet) {
    file.json["images"] = json::array(
        {{{"uri",
           "data:image/"
           "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg="
           "="}}});
    file.json["samplers"] =
        json::array({{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9729}}});
    file.json["textures"] = json::array({{{"source", 0}, {"sampler", 0}}});
    const json transform = {{"offset", {0.5, 0.25}}, {"scale", {2, 3}}, {"rotation", 0.5}, {"texCoord", 1}};
    file.json["materials"] =
        json::array({{{"emissiveTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}}}});
    const Scene scene = load();
    ASSERT_TRUE(scene.warnings.empty()) << scene.warnings[0];
    EXPECT_EQ(scene.images[0].texels.size(), 4u);
    const TextureRef& texture = scene.materials[0].emissive_texture;
    EXPECT_EQ(texture.image, 0);
    EXPECT_EQ(texture.texcoord, 1);
    EXPECT_EQ(texture.offset, glm::vec2(0.5f, 0.25f));
    EXPECT_EQ(texture.scale, glm::vec2(2.0f, 3.0f));
    EXPECT_EQ(texture.rotation, 0.5f);
    EXPECT_EQ(texture.wrap_s, Wrap::kClampToEdge);
    EXPECT_EQ(texture.wrap_t, Wrap::kMirroredRepeat);
    EXPECT_TRUE(texture.nearest);
    EXPECT_FALSE(texture.mipmapped);
}

TEST_F(GltfReader, NodesOutsideTheDefaultSceneAndHiddenOnesAreNotShown) {
    file.triangle();
    file.json["nodes"] =
        json::array({{{"mesh", 0}},
                     {{"mesh", 0}},
                     {{"children", {3}}, {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}},
                     {{"mesh", 0}}});
    file.json["scenes"] = json::array({{{"nodes", {0}}}, {{"nodes", {1, 2}}}});
    file.json["scene"] = 1;
    const Scene scene = load();
    EXPECT_EQ(count_triangles(scene), 1);
    EXPECT_EQ(placements(scene)[0].node, 1);
    EXPECT_FALSE(scene.nodes[3].visible);
}

TEST_F(GltfReader, LensAndShutterComeFromExtras) {
    file.json["cameras"] = json::array({{{"type", "perspective"},
                                         {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}},
                                         {"extras", {{"fstop", 2.8}, {"shutter", 0.25}}}}});
    file.node({{"camera", 0},
               {"extras", {{"fstop", 16}, {"focusDistance", 3.5}, {"apertureBlades", 6}, {"sensorWidth", "wide"}}}});
    const Scene scene = load();
    const LensInfo& lens = scene.cameras[0].lens;
    EXPECT_EQ(lens.fstop, 2.8);
    EXPECT_EQ(lens.shutter, 0.25);
    EXPECT_EQ(lens.focus_distance, 3.5);
    EXPECT_EQ(lens.aperture_blades, 6);
    EXPECT_FALSE(lens.sensor_width_mm.has_value());
    EXPECT_TRUE(mentions(scene.warnings, "sensorWidth"));
}

TEST_F(GltfReader, NodesThatShareACameraHaveTheirOwnLenses) {
    file.json["cameras"] = json::array(
        {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}, {"extras", {{"shutter", 0.25}}}}});
    file.node({{"camera", 0}, {"extras", {{"fstop", 2.8}}}});
    file.node({{"camera", 0}});
    file.node({{"camera", 0}, {"extras", {{"fstop", 2.8}}}});
    file.node({{"camera", 0}, {"extras", {{"fstop", 16}, {"focusDistance", 3}}}});
    const int times = file.floats("SCALAR", {0, 1});
    const int angles = file.floats("SCALAR", {0.7f, 0.5f}), stops = file.floats("SCALAR", {16, 8});
    const auto channel = [](int sampler, const char* pointer) {
        return json{
            {"sampler", sampler},
            {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}};
    };
    file.json["animations"] = {
        {{"samplers", {{{"input", times}, {"output", angles}}, {{"input", times}, {"output", stops}}}},
         {"channels", {channel(0, "/cameras/0/perspective/yfov"), channel(1, "/nodes/3/extras/fstop")}}}};
    const Scene scene = load();
    const auto lens = [&](std::size_t node) {
        return scene.cameras[static_cast<std::size_t>(scene.nodes[node].camera)].lens;
    };
    EXPECT_EQ(scene.cameras.size(), 3u);
    EXPECT_EQ(scene.nodes[0].camera, 0);
    EXPECT_EQ(scene.nodes[2].camera, 0);
    EXPECT_EQ(lens(0).fstop, 2.8);
    EXPECT_FALSE(lens(1).fstop.has_value());
    EXPECT_EQ(lens(3).fstop, 16);
    EXPECT_EQ(lens(3).focus_distance, 3);
    for (std::size_t node : {0, 1, 3}) EXPECT_EQ(lens(node).shutter, 0.25);
    // The angle of all of them changes, the f-number of one.
    std::vector<std::pair<Index, ChannelPath>> moved;
    for (const Channel& c : scene.animations[0].channels) moved.emplace_back(c.camera, c.path);
    std::sort(moved.begin(), moved.end());
    EXPECT_EQ(
        moved,
        (std::vector<std::pair<Index, ChannelPath>>{
            {0, ChannelPath::kYfov}, {1, ChannelPath::kYfov}, {2, ChannelPath::kYfov}, {2, ChannelPath::kFstop}}));
}

TEST_F(GltfReader, LensesOfNodesDoNotCopyACameraWithoutBound) {
    file.json["cameras"] = json::array({{{"type", "perspective"},
                                         {"name", std::string(std::size_t{1} << 20, 'n')},
                                         {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}});
    for (int i = 0; i < 100; ++i) file.node({{"camera", 0}, {"extras", {{"fstop", 1 + i}}}});
    EXPECT_THROW(load(), Error);
}

TEST_F(GltfReader, AnOrthographicCameraHasNoFstop) {
    file.json["cameras"] = json::array(
        {{{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 9}}}}});
    file.node({{"camera", 0}, {"extras", {{"fstop", 2}}}});
    EXPECT_TRUE(mentions(load().warnings, "orthographic, so it has no fstop"));
}

TEST_F(GltfReader, ThePhysicalCameraExtensionComesBeforeExtras) {
    const json sensor = {{"imageSensor", {{"pixels", {4000, 3000}}, {"pixelSize", {0.000009, 0.000009}}}},
                         {"lens", {{"focalLength", 0.05}, {"apertureRadius", 0.0125}, {"focusDistance", 4}}}};
    file.json["cameras"] = json::array({{{"type", "perspective"},
                                         {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}},
                                         {"extras", {{"fstop", 16}}},
                                         {"extensions", {{"EXT_cameras_sensor", sensor}}}}});
    const LensInfo lens = load().cameras[0].lens;
    EXPECT_DOUBLE_EQ(lens.fstop.value(), 2.0);
    EXPECT_DOUBLE_EQ(lens.focal_length_mm.value(), 50.0);
    EXPECT_DOUBLE_EQ(lens.sensor_width_mm.value(), 36.0);
    EXPECT_DOUBLE_EQ(lens.focus_distance.value(), 4.0);
}

TEST_F(GltfReader, PassesOverALensInExtrasThatIsNone) {
    file.json["cameras"] = json::array({{{"type", "perspective"},
                                         {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}},
                                         {"extras", {{"focusRange", {3, 2}}, {"tilt", 95}, {"catsEye", -1}}}}});
    file.node({{"camera", 0}, {"extras", {{"focusRange", {1.5, 2}}, {"tilt", 30}}}});
    const Scene scene = load();
    EXPECT_EQ(scene.cameras[0].lens.focus_range, (std::array<double, 2>{1.5, 2.0})) << "the node's";
    EXPECT_EQ(scene.cameras[0].lens.tilt_deg, 30.0);
    EXPECT_FALSE(scene.cameras[0].lens.cats_eye.has_value());
    for (const char* key : {"focusRange", "tilt", "catsEye"}) EXPECT_TRUE(mentions(scene.warnings, key)) << key;
}

TEST_F(GltfReader, ABackgroundIsThreeColoursOfLight) {
    for (const auto& wrong : {json("blue"), json{1, 2}, json{1, -2, 3}, json{1, 2, "x"}, json{1, 2, 1e9}}) {
        file.json["scenes"] = json::array({{{"extras", {{"background", wrong}}}}});
        const Scene scene = load();
        EXPECT_FALSE(scene.background.has_value()) << wrong;
        EXPECT_TRUE(mentions(scene.warnings, "background")) << wrong;
    }
}

TEST_F(GltfReader, AnIrisHasThreeBladesOrNone) {
    for (const auto& [blades, wanted] : std::initializer_list<std::pair<double, int>>{
             {0, 0}, {3, 3}, {64, 64}, {1, -1}, {2, -1}, {65, -1}, {6.5, -1}}) {
        file.json["cameras"] = json::array({{{"type", "perspective"},
                                             {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}},
                                             {"extras", {{"apertureBlades", blades}}}}});
        const Scene scene = load();
        EXPECT_EQ(scene.cameras[0].lens.aperture_blades.value_or(-1), wanted) << blades;
        EXPECT_EQ(mentions(scene.warnings, "apertureBlades"), wanted < 0) << blades;
    }
}

TEST_F(GltfReader, PointersMoveNodesAndCameras) {
    file.json["cameras"] = json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}});
    file.node({{"camera", 0}});
    file.json["extensionsUsed"] = {"KHR_animation_pointer"};
    const int times = file.floats("SCALAR", {0, 1}), one = file.floats("SCALAR", {0.5f, 1.5f}),
              three = file.floats("VEC3", {0, 0, 0, 1, 2, 3});
    const json samplers = json::array({{{"input", times}, {"output", one}}, {{"input", times}, {"output", three}}});
    const auto channel = [](int sampler, const char* pointer) {
        return json{
            {"sampler", sampler},
            {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}};
    };
    file.json["animations"] = json::array(
        {{{"samplers", samplers},
          {"channels",
           json::array({channel(0, "/cameras/0/perspective/yfov"), channel(0, "/nodes/0/extras/focusDistance"),
                        channel(1, "/nodes/0/translation"), channel(0, "/cameras/1/perspective/yfov"),
                        channel(0, "/materials/0/pbrMetallicRoughness/metallicFactor"),
                        channel(0, "/cameras/00x/perspective/yfov"), channel(0, "")})}}});
    const Scene scene = load();
    const std::vector<Channel>& channels = scene.animations[0].channels;
    ASSERT_EQ(channels.size(), 3u);
    EXPECT_EQ(channels[0].path, ChannelPath::kYfov);
    EXPECT_EQ(channels[0].camera, 0);
    EXPECT_EQ(channels[1].path, ChannelPath::kFocusDistance);
    EXPECT_EQ(channels[1].camera, 0);
    EXPECT_EQ(channels[2].path, ChannelPath::kTranslation);
    EXPECT_EQ(channels[2].node, 0);
    EXPECT_TRUE(mentions(scene.warnings, "moves /materials/0"));
    EXPECT_TRUE(mentions(scene.warnings, "moves /cameras/1"));
    const Pose pose = evaluate(scene, choose_animations(scene, "all"), 0.5);
    EXPECT_DOUBLE_EQ(camera_at(scene, pose, 0).yfov, 1.0);
    EXPECT_DOUBLE_EQ(camera_at(scene, pose, 0).lens.focus_distance.value(), 1.0);
    EXPECT_EQ(scene.cameras[0].yfov, 0.7) << "the scene stays as it is";
}

TEST_F(GltfReader, OnlyRequiredExtensionsAreRefused) {
    file.triangle();
    file.json["extensionsUsed"] = {"KHR_materials_iridescence"};
    EXPECT_TRUE(mentions(load().warnings, "show no colours"));
    file.json["extensionsRequired"] = {"KHR_materials_iridescence"};
    EXPECT_EQ(refusal(), "test.gltf: requires the glTF extension KHR_materials_iridescence, which is not supported");
}

TEST_F(GltfReader, ReadsPastTheEndAreRefusedWithTheByte) {
    file.triangle();
    file.json["accessors"][0]["count"] = 4;
    EXPECT_EQ(refusal(), "test.gltf: accessor 0 reads past its buffer view (byte 48 of 36)");
    file.json["accessors"][0]["count"] = 3;
    file.json["bufferViews"][0]["byteLength"] = 37;
    EXPECT_EQ(refusal(), "test.gltf: buffer view 0 reads past its buffer 0 (byte 37 of 36)");
}

TEST_F(GltfReader, HugeNegativeAndFractionalNumbersAreRefused) {
    file.triangle();
    for (const json& count :
         {json(-1), json(1.5), json(1e300), json(18446744073709551615u), json("3"), json(nullptr)}) {
        file.json["accessors"][0]["count"] = count;
        EXPECT_NE(refusal(), "") << count;
    }
    // Zeros that no buffer backs must not be a way to ask for all memory.
    file.json["accessors"][0] = {{"componentType", 5126}, {"count", 1000000000000}, {"type", "VEC3"}};
    EXPECT_NE(refusal(), "");
}

TEST_F(GltfReader, AnAccessorUsedAMillionTimesIsRefused) {
    file.json["accessors"].push_back({{"componentType", 5126}, {"count", 1 << 20}, {"type", "MAT4"}});
    file.json["nodes"] = json::array({json::object()});
    for (int i = 0; i < 20; ++i) file.json["skins"].push_back({{"joints", {0}}, {"inverseBindMatrices", 0}});
    EXPECT_NE(refusal().find("more data than can be read"), std::string::npos);
}

TEST_F(GltfReader, CyclesAndSecondParentsAreRefused) {
    file.json["nodes"] = json::array({{{"children", {1}}}, {{"children", {0}}}});
    EXPECT_EQ(refusal(), "test.gltf: node 0 is its own ancestor");
    file.json["nodes"] = json::array({{{"children", {2}}}, {{"children", {2}}}, json::object()});
    EXPECT_EQ(refusal(), "test.gltf: node 2 has two parents, nodes 0 and 1");
}

TEST_F(GltfReader, NonFinitePositionsAreRefusedAndNormalsReplaced) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    file.triangle();
    file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
        file.floats("VEC3", {nan, 0, 0, 0, 0, 0, 0, 0, 2});
    const Scene scene = load();
    for (const glm::vec3& normal : scene.meshes[0].primitives[0].normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1));
    EXPECT_EQ(scene.warnings.size(), 1u);
    file.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
        file.floats("VEC3", {nan, 0, 0, 0, 0, 0, 0, 0, 0});
    EXPECT_EQ(refusal(), "test.gltf: mesh 0, primitive 0 has a POSITION that is not finite");
}

TEST_F(GltfReader, AWrongTypeInAnUnusedObjectIsRefused) {
    file.json["nodes"] = json::array({{{"extensions", {{"SOME_extension", 3}}}}});
    EXPECT_EQ(refusal(), "test.gltf: nodes[0].extensions.SOME_extension is not an object");
}

TEST_F(GltfReader, AMissingFileIsNamedInFull) {
    try {
        load_scene("no/such/scene.glb");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kScene);
        EXPECT_STREQ(error.what(), "no/such/scene.glb: No such file or directory");
    }
}

TEST_F(GltfReader, BuffersAreFoundUnderPercentEncodedNames) {
    file.triangle();
    file.save(folder);
    std::filesystem::rename(folder.path() / "test.bin", folder.path() / "a b.bin");
    file.json["buffers"][0]["uri"] = "a%20b.bin";
    const auto path = folder.write("test.gltf", file.json.dump());
    EXPECT_EQ(count_triangles(load_scene(path.string())), 1);
}

TEST_F(GltfReader, AnimationsOfTheWrongLengthAreRefused) {
    file.node(json::object());
    const int times = file.floats("SCALAR", {0, 1}), values = file.floats("VEC3", {0, 0, 0});
    file.json["animations"] = json::array(
        {{{"samplers", json::array({{{"input", times}, {"output", values}}})},
          {"channels", json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}})}}});
    EXPECT_EQ(refusal(), "test.gltf: animation 0, sampler 0 has 3 numbers for 2 keys, which take 3 each");
}

}  // namespace
}  // namespace pentaprism
