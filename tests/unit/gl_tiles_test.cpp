// The compute pipeline of OpenGL: when it is taken, and that its lists lose nothing, however long.

#include <algorithm>

#include "support/gl_look.h"
#include "support/scenes.h"

namespace pentaprism {
namespace {

using namespace support;

// As on a device whose storage blocks hold that many bytes.
class SmallBlocks {
  public:
    explicit SmallBlocks(std::int64_t bytes) { gl::Device::get().pretend_block_bytes(bytes); }
    ~SmallBlocks() { gl::Device::get().pretend_block_bytes(0); }
};

std::int64_t largest_array(const Frame& frame) {
    return static_cast<std::int64_t>(
        std::max(frame.points.size() * sizeof(glm::vec4), frame.corners.size() * sizeof(std::uint32_t)));
}

// Squares behind one another, each a little farther and `layers` times there.
Scene stack_of_squares(int count, float half, int layers = 1) {
    Scene scene;
    scene.name = "stack";
    support::add_camera(scene, "camera", {0, 0, 2});
    const Index first = support::add_square(scene, "square", {0, 0, 0}, half);
    Primitive& stack = scene.meshes[scene.nodes[first].mesh].primitives[0];
    const Primitive square = stack;
    stack = {};
    for (int k = 0; k < count; ++k) {
        for (const glm::vec3& p : square.positions)
            stack.positions.emplace_back(p.x, p.y, -1e-3f * static_cast<float>(k % 977));
        stack.normals.insert(stack.normals.end(), square.normals.begin(), square.normals.end());
        for (int layer = 0; layer < layers; ++layer)
            for (const std::uint32_t i : square.indices) stack.indices.push_back(i + 4 * static_cast<std::uint32_t>(k));
    }
    return scene;
}

TEST_F(GlBackend, LosesNothingWhereListsDoNotFitAtOnce) {
    const RenderSettings settings = settings_of(64, 64, 10);  // more passes than one, which use lists again
    const Scene scene = stack_of_squares(400, 0.4f, 3);
    const PosedPicture picture = pose_picture(scene, settings, 0);
    const Seen roomy = look(picture, By::kCompute, "none");
    // A block holds neither all triangles, 16 bytes each, nor, of those of a batch, the tiles that each is in, 4 bytes
    // each: several batches, and several ranges of tiles. In a tile each is tested 64 times a sample at most.
    const std::int64_t bytes = largest_array(picture.frame), batches = (16 * 2400 + bytes - 1) / bytes;
    EXPECT_GT(batches, 1);
    EXPECT_GT(4 * (roomy.counts.tested / (64 * 10)) / batches, bytes);
    const SmallBlocks small(bytes);
    const Seen cramped = look(picture, By::kCompute, "none");
    EXPECT_EQ(roomy.triangle, cramped.triangle);
    EXPECT_EQ(roomy.depth, cramped.depth);
    EXPECT_EQ(roomy.map.tested, cramped.map.tested);
    EXPECT_EQ(roomy.map.covered, cramped.map.covered);
}

// Drivers may leave long loops: 20000 triangles in a tile, and a triangle in 68400 tiles.
TEST_F(GlBackend, LosesNothingInLongLists) {
    expect_same(stack_of_squares(10000, 0.01f), settings_of(16, 16, 9), 0, "none");
    expect_same(stack_of_squares(300, 0.2f), settings_of(16, 16, 9), 0, "hull@tile+hull+clip-space");
    const Scene square = stack_of_squares(1, 3.0f);
    const PosedPicture wide = pose_picture(square, settings_of(2400, 1800, 1), 0);
    const Seen cpu = look(wide, By::kCpu, "none"), gl = look(wide, By::kCompute, "none");
    EXPECT_EQ(gl.counts.covered, 2400 * 1800);
    EXPECT_EQ(cpu.triangle, gl.triangle);
    EXPECT_EQ(cpu.depth, gl.depth);
}

TEST_F(GlBackend, TakesComputeWhereItFitsElseGeometry) {
    const Scene scene = load_scene("builtin:cubes");
    const PosedPicture picture = pose_picture(scene, settings_of(32, 32, 1), 0);
    EXPECT_EQ(look(picture, By::kCpu, "none").pipeline, "");
    EXPECT_EQ(look(picture, By::kAuto, "none").pipeline, "compute");
    const SmallBlocks small(largest_array(picture.frame) - 1);
    EXPECT_EQ(look(picture, By::kAuto, "none").pipeline, "geometry");
    try {
        look(picture, By::kCompute, "none");
        FAIL() << "compute was taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kBackend);
        const std::string said = error.what();
        EXPECT_EQ(said.find('\n'), said.npos);
        EXPECT_EQ(said.find("--gl-pipeline compute: "), 0u) << said;
    }
}

}  // namespace
}  // namespace pentaprism
