#pragma once
// What both file readers do to meshes that lack something.

#include <pentaprism/scene.h>
#include <span>
#include <vector>

namespace pentaprism {

/// Unit normals, each the mean of the normals of the triangles around the vertex weighted by their areas. Vertices
/// without area around them get (0, 0, 1).
std::vector<glm::vec3> smooth_normals(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices);

/// Leaves out the vertices that no triangle names: exporters like to share one vertex buffer between many primitives.
void drop_unused_vertices(Primitive& primitive);

/// Gives every triangle its own three vertices (attributes and morph targets follow), and its own flat normal.
void make_flat(Primitive& primitive);

}  // namespace pentaprism
