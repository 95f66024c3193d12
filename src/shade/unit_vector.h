#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace pentaprism {

/// The vector made unit; another one if it has no direction.
inline glm::vec3 normalized_or(const glm::vec3& v, const glm::vec3& otherwise) {
    const float length2 = glm::dot(v, v);
    return length2 > 0.0f && std::isfinite(length2) ? v / std::sqrt(length2) : otherwise;
}

}  // namespace pentaprism
