// What write_glb writes, load_scene reads back.
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <pentaprism/error.h>
#include <pentaprism/scene.h>

namespace pentaprism {
namespace {

/// A scene with one of everything that a file can hold.
Scene one_of_everything() {
    Scene scene;
    scene.name = "everything";

    Image image{"picture", 3, 2, {}};
    for (int i = 0; i < 24; ++i) image.texels.push_back(static_cast<std::uint8_t>(11 * i));
    scene.images.push_back(image);

    Material rich;
    rich.name = "rich";
    rich.base_color = {0.1f, 0.25f, 0.3f, 0.9f};
    rich.base_color_texture.image = 0;
    rich.base_color_texture.texcoord = 1;
    rich.base_color_texture.wrap_s = Wrap::kMirroredRepeat;
    rich.base_color_texture.wrap_t = Wrap::kClampToEdge;
    rich.base_color_texture.nearest = true;
    rich.base_color_texture.offset = {0.125f, -0.5f};
    rich.base_color_texture.scale = {3.0f, 0.3f};
    rich.base_color_texture.rotation = 0.7f;
    rich.metallic = 0.3f;
    rich.roughness = 0.6f;
    rich.metallic_roughness_texture.image = 0;
    rich.normal_texture.image = 0;
    rich.normal_scale = 0.4f;
    rich.occlusion_texture.image = 0;
    rich.occlusion_strength = 0.7f;
    rich.emissive = {7.3f, 0.1f, 2.0f};
    rich.emissive_texture.image = 0;
    rich.emissive_texture.mipmapped = false;
    rich.alpha_mode = AlphaMode::kMask;
    rich.alpha_cutoff = 0.35f;
    rich.double_sided = true;
    Material plain;
    plain.name = "plain";
    plain.alpha_mode = AlphaMode::kBlend;
    plain.unlit = true;
    plain.emissive = {0.2f, 0.0f, 0.7f};
    scene.materials = {rich, plain};

    Primitive skinned;
    skinned.positions = {{0.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.1f}, {0.0f, 1.0f, -0.3f}, {1.0f, 1.1f, 0.0f}};
    skinned.normals.assign(4, {0.0f, 0.0f, 1.0f});
    skinned.tangents.assign(4, {1.0f, 0.0f, 0.0f, -1.0f});
    skinned.texcoords[0] = {{0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}, {1.0f, 1.0f}};
    skinned.texcoords[1] = {{0.5f, 0.25f}, {2.0f, 0.0f}, {-1.0f, 1.0f}, {0.1f, 0.2f}};
    skinned.colors = {
        {1.0f, 0.5f, 0.25f, 1.0f}, {0.1f, 0.2f, 0.3f, 0.4f}, {0.0f, 0.0f, 0.0f, 1.0f}, {1.0f, 1.0f, 1.0f, 0.5f}};
    skinned.influences = 8;
    for (int vertex = 0; vertex < 4; ++vertex)
        for (int k = 0; k < 8; ++k) {
            skinned.joints.push_back(static_cast<std::uint16_t>((vertex + k) % 2));
            skinned.weights.push_back(0.125f);
        }
    skinned.indices = {0, 1, 2, 2, 1, 3};
    skinned.material = 0;
    Primitive morphed;
    morphed.positions = {{0.0f, 0.0f, 0.0f}, {2.0f, 0.0f, 0.0f}, {0.0f, 2.0f, 0.0f}};
    morphed.normals.assign(3, {0.0f, 0.0f, 1.0f});
    morphed.indices = {0, 1, 2};
    morphed.material = 1;
    morphed.targets = {{{{0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 2.0f}, {0.0f, 0.0f, 3.0f}}, {}, {}},
                       {{{1.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}},
                        {{0.0f, 0.1f, 0.0f}, {0.0f, 0.1f, 0.0f}, {0.0f, 0.1f, 0.0f}},
                        {}}};
    scene.meshes = {{"skinned", {skinned}, {}}, {"morphed", {morphed}, {0.25f, 0.5f}}};

    const auto add_node = [&scene](std::string name, Index parent) -> Node& {
        Node node;
        node.name = std::move(name);
        node.parent = parent;
        const auto index = static_cast<Index>(scene.nodes.size());
        if (parent == kNone)
            scene.roots.push_back(index);
        else
            scene.nodes[std::size_t(parent)].children.push_back(index);
        scene.nodes.push_back(node);
        return scene.nodes.back();
    };
    Node& root = add_node("root", kNone);
    root.transform = {
        {1.0, -2.0, 0.1}, glm::angleAxis(0.8, glm::normalize(glm::dvec3(1.0, 2.0, 3.0))), {1.0, 2.0, 0.5}};
    Node& body = add_node("body", 0);
    body.mesh = 0;
    body.skin = 0;
    add_node("joint 1", 0);
    add_node("joint 2", 2);
    Node& face = add_node("face", kNone);
    face.mesh = 1;
    face.weights = {0.75f, 0.1f};
    face.matrix = glm::translate(glm::dmat4(1.0), {0.5, 0.25, -4.0});
    Node& crowd = add_node("crowd", kNone);
    crowd.mesh = 1;
    crowd.instances = {{{0.0, 0.5, 1.0}, {1.0, 0.0, 0.0, 0.0}, glm::dvec3(1.0)},
                       {{2.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}, {1.0, -1.0, 3.0}}};
    add_node("camera 1", kNone).camera = 0;
    add_node("camera 2", kNone).camera = 1;
    add_node("sun", kNone).light = 0;
    add_node("lamp", kNone).light = 1;
    add_node("torch", kNone).light = 2;

    scene.skins = {{"bones", {2, 3}, {glm::mat4(1.0f), glm::translate(glm::mat4(1.0f), {0.0f, -1.0f, 0.5f})}}};

    Camera lens;
    lens.name = "macro";
    lens.yfov = 0.61;
    lens.aspect = 1.5;
    lens.znear = 0.03;
    lens.zfar = 70.0;
    lens.lens.fstop = 2.8;
    lens.lens.focus_distance = 0.6;
    lens.lens.focal_length_mm = 35.0;
    lens.lens.sensor_width_mm = 36.0;
    lens.lens.shutter = 0.75;
    lens.lens.aperture_rotation_deg = 12.5;
    lens.lens.aperture_ratio = 1.8;
    lens.lens.aperture_blades = 6;
    lens.lens.focus_range = {0.4, 0.9};
    lens.lens.max_foreground_blur = 7.5;
    lens.lens.tilt_deg = -20.0;
    lens.lens.swing_deg = 5.0;
    lens.lens.cats_eye = 0.5;
    Camera flat;
    flat.name = "plan";
    flat.perspective = false;
    flat.xmag = 3.0;
    flat.ymag = 2.0;
    flat.znear = 0.1;
    flat.zfar = 9.0;
    scene.cameras = {lens, flat};

    Light sun{
        "sun",     LightKind::kDirectional, {1.0f, 0.9f, 0.8f}, 3.5f, std::numeric_limits<float>::infinity(), 0.0f,
        0.7853982f};
    Light lamp{"lamp", LightKind::kPoint, {0.2f, 0.3f, 1.0f}, 12.0f, 4.5f, 0.0f, 0.7853982f};
    Light torch{"torch", LightKind::kSpot, {1.0f, 1.0f, 1.0f}, 8.0f, std::numeric_limits<float>::infinity(), 0.2f,
                0.5f};
    scene.lights = {sun, lamp, torch};

    Animation shot{"shot", {}, 2.0};
    shot.channels.push_back({0,
                             kNone,
                             ChannelPath::kTranslation,
                             Interpolation::kLinear,
                             3,
                             {0.0f, 2.0f},
                             {1.0f, -2.0f, 0.1f, 4.0f, 5.0f, 6.0f}});
    shot.channels.push_back(
        {0, kNone, ChannelPath::kScale, Interpolation::kStep, 3, {0.0f, 2.0f}, {1.0f, 2.0f, 0.5f, 4.0f, 5.0f, 6.0f}});
    shot.channels.push_back(
        {3, kNone, ChannelPath::kRotation, Interpolation::kCubicSpline, 4, {0.0f, 1.0f}, {0.0f, 0.0f, 0.0f, 0.0f, 0.0f,
                                                                                          0.0f, 0.0f, 1.0f, 0.1f, 0.0f,
                                                                                          0.0f, 0.0f, 0.2f, 0.0f, 0.0f,
                                                                                          0.0f, 0.0f, 1.0f, 0.0f, 0.0f,
                                                                                          0.0f, 0.0f, 0.0f, 0.0f}});
    shot.channels.push_back(
        {4, kNone, ChannelPath::kWeights, Interpolation::kLinear, 2, {0.0f, 1.0f}, {0.0f, 1.0f, 0.5f, 0.25f}});
    shot.channels.push_back({kNone, 0, ChannelPath::kYfov, Interpolation::kLinear, 1, {0.0f, 1.0f}, {0.6f, 0.3f}});
    shot.channels.push_back(
        {kNone, 0, ChannelPath::kFocusDistance, Interpolation::kStep, 1, {0.0f, 1.0f}, {2.0f, 3.5f}});
    shot.channels.push_back({kNone, 0, ChannelPath::kFstop, Interpolation::kLinear, 1, {0.0f, 1.0f}, {2.0f, 4.0f}});
    scene.animations = {shot};
    return scene;
}

class GltfWriter : public testing::Test {
  protected:
    void SetUp() override {
        file_ = std::filesystem::path(testing::TempDir()) /
                (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".glb");
    }
    void TearDown() override { std::filesystem::remove(file_); }

    Scene written_and_read(const Scene& scene) {
        write_glb(scene, file_);
        Scene read = load_scene(file_.string());
        EXPECT_TRUE(read.warnings.empty()) << read.warnings.front();
        return read;
    }
    std::filesystem::path file_;
};

void expect_same(const TextureRef& a, const TextureRef& b) {
    EXPECT_EQ(a.image, b.image);
    if (a.image == kNone) return;
    EXPECT_EQ(a.texcoord, b.texcoord);
    EXPECT_EQ(a.wrap_s, b.wrap_s);
    EXPECT_EQ(a.wrap_t, b.wrap_t);
    EXPECT_EQ(a.nearest, b.nearest);
    EXPECT_EQ(a.mipmapped, b.mipmapped);
    EXPECT_EQ(a.offset, b.offset);
    EXPECT_EQ(a.scale, b.scale);
    EXPECT_EQ(a.rotation, b.rotation);
}

void expect_same(const Primitive& a, const Primitive& b) {
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.normals, b.normals);
    EXPECT_EQ(a.tangents, b.tangents);
    EXPECT_EQ(a.texcoords, b.texcoords);
    EXPECT_EQ(a.colors, b.colors);
    EXPECT_EQ(a.influences, b.influences);
    EXPECT_EQ(a.joints, b.joints);
    EXPECT_EQ(a.weights, b.weights);
    EXPECT_EQ(a.indices, b.indices);
    EXPECT_EQ(a.material, b.material);
    ASSERT_EQ(a.targets.size(), b.targets.size());
    for (std::size_t i = 0; i < a.targets.size(); ++i) {
        EXPECT_EQ(a.targets[i].positions, b.targets[i].positions);
        EXPECT_EQ(a.targets[i].normals, b.targets[i].normals);
        EXPECT_EQ(a.targets[i].tangents, b.targets[i].tangents);
    }
}

void expect_same(const Transform& a, const Transform& b) {
    EXPECT_NEAR(glm::length(a.translation - b.translation), 0.0, 1e-12);
    EXPECT_NEAR(std::abs(glm::dot(a.rotation, b.rotation)), 1.0, 1e-12);
    EXPECT_NEAR(glm::length(a.scale - b.scale), 0.0, 1e-12);
}

TEST_F(GltfWriter, KeepsImagesTexelForTexel) {
    const Scene scene = one_of_everything(), read = written_and_read(scene);
    ASSERT_EQ(read.images.size(), 1u);
    EXPECT_EQ(read.images[0].name, "picture");
    EXPECT_EQ(read.images[0].width, 3);
    EXPECT_EQ(read.images[0].height, 2);
    EXPECT_EQ(read.images[0].texels, scene.images[0].texels);
}

TEST_F(GltfWriter, KeepsMaterialsAndTheirTextures) {
    const Scene scene = one_of_everything(), read = written_and_read(scene);
    ASSERT_EQ(read.materials.size(), scene.materials.size());
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const Material &a = scene.materials[i], &b = read.materials[i];
        EXPECT_EQ(a.name, b.name);
        EXPECT_EQ(a.base_color, b.base_color);
        EXPECT_EQ(a.metallic, b.metallic);
        EXPECT_EQ(a.roughness, b.roughness);
        EXPECT_EQ(a.normal_scale, b.normal_scale);
        EXPECT_EQ(a.occlusion_strength, b.occlusion_strength);
        EXPECT_EQ(a.emissive, b.emissive);
        EXPECT_EQ(a.alpha_mode, b.alpha_mode);
        EXPECT_EQ(a.alpha_cutoff, b.alpha_cutoff);
        EXPECT_EQ(a.double_sided, b.double_sided);
        EXPECT_EQ(a.unlit, b.unlit);
        expect_same(a.base_color_texture, b.base_color_texture);
        expect_same(a.metallic_roughness_texture, b.metallic_roughness_texture);
        expect_same(a.normal_texture, b.normal_texture);
        expect_same(a.occlusion_texture, b.occlusion_texture);
        expect_same(a.emissive_texture, b.emissive_texture);
    }
}

TEST_F(GltfWriter, KeepsEveryVertexAttributeAndMorphTarget) {
    const Scene scene = one_of_everything(), read = written_and_read(scene);
    ASSERT_EQ(read.meshes.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(read.meshes[i].name, scene.meshes[i].name);
        EXPECT_EQ(read.meshes[i].weights, scene.meshes[i].weights);
        ASSERT_EQ(read.meshes[i].primitives.size(), 1u);
        expect_same(scene.meshes[i].primitives[0], read.meshes[i].primitives[0]);
    }
}

TEST_F(GltfWriter, KeepsTheNodesTheirSkinsAndInstances) {
    const Scene scene = one_of_everything(), read = written_and_read(scene);
    EXPECT_EQ(read.roots, scene.roots);
    ASSERT_EQ(read.nodes.size(), scene.nodes.size());
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        const Node &a = scene.nodes[i], &b = read.nodes[i];
        SCOPED_TRACE(a.name);
        EXPECT_EQ(a.name, b.name);
        EXPECT_EQ(a.parent, b.parent);
        EXPECT_EQ(a.children, b.children);
        EXPECT_EQ(a.mesh, b.mesh);
        EXPECT_EQ(a.skin, b.skin);
        EXPECT_EQ(a.camera, b.camera);
        EXPECT_EQ(a.light, b.light);
        EXPECT_EQ(a.weights, b.weights);
        EXPECT_EQ(a.matrix, b.matrix);
        if (!a.matrix) expect_same(a.transform, b.transform);
        ASSERT_EQ(a.instances.size(), b.instances.size());
        for (std::size_t k = 0; k < a.instances.size(); ++k) expect_same(a.instances[k], b.instances[k]);
    }
    ASSERT_EQ(read.skins.size(), 1u);
    EXPECT_EQ(read.skins[0].joints, scene.skins[0].joints);
    EXPECT_EQ(read.skins[0].inverse_bind_matrices, scene.skins[0].inverse_bind_matrices);
}

TEST_F(GltfWriter, KeepsCamerasWithLensAndShutter) {
    const Scene scene = one_of_everything(), read = written_and_read(scene);
    ASSERT_EQ(read.cameras.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const Camera &a = scene.cameras[i], &b = read.cameras[i];
        EXPECT_EQ(a.name, b.name);
        EXPECT_EQ(a.perspective, b.perspective);
        EXPECT_EQ(a.yfov, b.yfov);
        EXPECT_EQ(a.aspect, b.aspect);
        EXPECT_EQ(a.xmag, b.xmag);
        EXPECT_EQ(a.ymag, b.ymag);
        EXPECT_EQ(a.znear, b.znear);
        EXPECT_EQ(a.zfar, b.zfar);
        EXPECT_EQ(a.lens.fstop, b.lens.fstop);
        EXPECT_EQ(a.lens.focus_distance, b.lens.focus_distance);
        EXPECT_EQ(a.lens.focal_length_mm, b.lens.focal_length_mm);
        EXPECT_EQ(a.lens.sensor_width_mm, b.lens.sensor_width_mm);
        EXPECT_EQ(a.lens.shutter, b.lens.shutter);
        EXPECT_EQ(a.lens.aperture_blades, b.lens.aperture_blades);
        EXPECT_EQ(a.lens.aperture_rotation_deg, b.lens.aperture_rotation_deg);
        EXPECT_EQ(a.lens.aperture_ratio, b.lens.aperture_ratio);
        EXPECT_EQ(a.lens.focus_range, b.lens.focus_range);
        EXPECT_EQ(a.lens.max_foreground_blur, b.lens.max_foreground_blur);
        EXPECT_EQ(a.lens.tilt_deg, b.lens.tilt_deg);
        EXPECT_EQ(a.lens.swing_deg, b.lens.swing_deg);
        EXPECT_EQ(a.lens.cats_eye, b.lens.cats_eye);
    }
}

TEST_F(GltfWriter, KeepsTheBackground) {
    Scene scene = one_of_everything();
    EXPECT_EQ(written_and_read(scene).background, scene.background);
    scene.background = glm::vec3(0.25f, 0.5f, 2.0f);
    EXPECT_EQ(written_and_read(scene).background, scene.background);
}

TEST_F(GltfWriter, KeepsLights) {
    const Scene scene = one_of_everything(), read = written_and_read(scene);
    ASSERT_EQ(read.lights.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        const Light &a = scene.lights[i], &b = read.lights[i];
        EXPECT_EQ(a.name, b.name);
        EXPECT_EQ(a.kind, b.kind);
        EXPECT_EQ(a.color, b.color);
        EXPECT_EQ(a.intensity, b.intensity);
        EXPECT_EQ(a.range, b.range);
    }
    EXPECT_EQ(read.lights[2].inner_cone, scene.lights[2].inner_cone);
    EXPECT_EQ(read.lights[2].outer_cone, scene.lights[2].outer_cone);
}

TEST_F(GltfWriter, KeepsAnimationsKeyForKey) {
    const Scene scene = one_of_everything(), read = written_and_read(scene);
    ASSERT_EQ(read.animations.size(), 1u);
    EXPECT_EQ(read.animations[0].name, "shot");
    EXPECT_EQ(read.animations[0].duration, 2.0);
    ASSERT_EQ(read.animations[0].channels.size(), scene.animations[0].channels.size());
    for (std::size_t i = 0; i < scene.animations[0].channels.size(); ++i) {
        const Channel &a = scene.animations[0].channels[i], &b = read.animations[0].channels[i];
        EXPECT_EQ(a.node, b.node);
        EXPECT_EQ(a.camera, b.camera);
        EXPECT_EQ(a.path, b.path);
        EXPECT_EQ(a.interpolation, b.interpolation);
        EXPECT_EQ(a.width, b.width);
        EXPECT_EQ(a.times, b.times);
        EXPECT_EQ(a.values, b.values);
    }
}

// The reader drops vertices that no triangle uses: the corners are what must stay.
std::vector<glm::vec3> corner_positions(const Primitive& primitive) {
    std::vector<glm::vec3> corners;
    for (const std::uint32_t index : primitive.indices) corners.push_back(primitive.positions[index]);
    return corners;
}

TEST_F(GltfWriter, WritesABuiltinSceneThatReadsBackTriangleForTriangle) {
    for (const char* name : {"cubes", "hand"}) {
        const Scene scene = make_builtin_scene(name), read = written_and_read(scene);
        EXPECT_EQ(count_triangles(read), count_triangles(scene));
        ASSERT_EQ(read.meshes.size(), scene.meshes.size());
        for (std::size_t i = 0; i < scene.meshes.size(); ++i)
            for (std::size_t k = 0; k < scene.meshes[i].primitives.size(); ++k)
                EXPECT_TRUE(corner_positions(scene.meshes[i].primitives[k]) ==
                            corner_positions(read.meshes[i].primitives[k]))
                    << scene.meshes[i].name;
    }
}

TEST_F(GltfWriter, LeavesNoFileWhenTheFolderIsMissing) {
    const std::filesystem::path nowhere = std::filesystem::path(testing::TempDir()) / "no such folder" / "scene.glb";
    try {
        write_glb(one_of_everything(), nowhere);
        FAIL() << "no exception";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kOutput);
        EXPECT_NE(std::string(error.what()).find("scene.glb"), std::string::npos) << error.what();
    }
}

TEST_F(GltfWriter, RefusesAMeshWithoutTriangles) {
    Scene scene;
    scene.meshes.push_back({"empty", {}, {}});
    EXPECT_THROW(write_glb(scene, file_), Error);
    EXPECT_FALSE(std::filesystem::exists(file_));
}

}  // namespace
}  // namespace pentaprism
