#pragma once
// Tangents of a mesh that has a normal map but brings none, as the tools that bake normal maps expect them.

#include <glm/vec4.hpp>
#include <pentaprism/scene.h>
#include <vector>

namespace pentaprism {

/// One for each vertex: unit length, perpendicular to the normal, along growing u of that set of texture coordinates;
/// w is +1 or -1: the bitangent cross(normal, tangent) * w runs along falling v (v points down). Empty if the
/// primitive lacks the coordinates.
std::vector<glm::vec4> make_tangents(const Primitive& primitive, int texcoord);

}  // namespace pentaprism
