#pragma once
// Scenes of a few triangles, made in the test that needs them, and their hits found without any culling.

#include <glm/geometric.hpp>
#include <memory>
#include <pentaprism/scene.h>
#include <utility>
#include <vector>

#include "bound/local_triangle.h"
#include "camera/view.h"
#include "cover/exact.h"
#include "cover/hits.h"
#include "frame/frame.h"
#include "frame/opacity.h"
#include "sample/sample_table.h"

namespace pentaprism::small_scene {

/// A square of half width `size` in the plane z = depth, facing +z, with texture coordinates from 0 to 1, v down.
inline Primitive square(float size, float depth, Index material) {
    Primitive primitive;
    primitive.positions = {{-size, -size, depth}, {size, -size, depth}, {size, size, depth}, {-size, size, depth}};
    primitive.normals.assign(4, {0.0f, 0.0f, 1.0f});
    primitive.texcoords[0] = {{0.0f, 1.0f}, {1.0f, 1.0f}, {1.0f, 0.0f}, {0.0f, 0.0f}};
    primitive.indices = {0, 1, 2, 0, 2, 3};
    primitive.material = material;
    return primitive;
}

/// A camera at the origin that sees [-1, 1] at depth z = -1 from bottom to top.
inline Scene scene_with_camera() {
    Scene scene;
    scene.cameras.emplace_back();
    scene.cameras[0].yfov = 2.0 * 0.78539816339744831;
    scene.nodes.emplace_back();
    scene.nodes[0].camera = 0;
    scene.roots = {0};
    return scene;
}

inline Index add_mesh(Scene& scene, std::vector<Primitive> primitives) {
    scene.meshes.push_back({"mesh", std::move(primitives), {}});
    scene.nodes.emplace_back();
    scene.nodes.back().mesh = static_cast<Index>(scene.meshes.size() - 1);
    const Index node = static_cast<Index>(scene.nodes.size() - 1);
    scene.roots.push_back(node);
    return node;
}

inline Index add_light(Scene& scene, const Light& light, const Transform& transform) {
    scene.lights.push_back(light);
    scene.nodes.emplace_back();
    scene.nodes.back().light = static_cast<Index>(scene.lights.size() - 1);
    scene.nodes.back().transform = transform;
    scene.roots.push_back(static_cast<Index>(scene.nodes.size() - 1));
    return scene.roots.back();
}

inline Frame frame_of(const Scene& scene, const RenderSettings& settings) {
    const View view = make_view(scene, settings, 0.0);
    Frame frame = pose_frame(scene, view, choose_animations(scene, "all"), settings.shutter);
    frame.textures = make_textures(scene);
    return frame;
}

/// Every triangle against every sample.
inline void find_hits(const Frame& frame, const SampleTable& table, const Tile& tile, Hits& hits) {
    hits.reset(table.slots(), tile);
    const CellCentre centre = cell_centre(frame.view, tile.cell_x(), tile.cell_y());
    for (std::uint32_t triangle = 0; triangle < frame.triangle_count(); ++triangle)
        for (int segment = 0; segment < frame.parts[frame.part_of[triangle]].segments; ++segment) {
            const LocalTriangle local = localize(frame, triangle, segment, centre);
            for (int y = tile.y0; y < tile.y1; ++y)
                for (int x = tile.x0; x < tile.x1; ++x)
                    for (int index = 0; index < table.spp(); ++index) {
                        const SampleHit hit =
                            cover_sample(local, local_sample(table.sample(x, y, index), x, y), centre);
                        const std::size_t at = hits.entry(x, y, table.slot_of(x, y, index));
                        if (!hit.hit || !(hit.depth < hits.depth[at])) continue;
                        if (!is_opaque_at(frame, triangle, hit.barycentrics, x, y, index, table)) continue;
                        hits.depth[at] = hit.depth;
                        hits.triangle[at] = triangle;
                    }
        }
}

}  // namespace pentaprism::small_scene
