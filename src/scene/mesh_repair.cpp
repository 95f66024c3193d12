#include "scene/mesh_repair.h"

#include <glm/geometric.hpp>
#include <limits>

namespace pentaprism {

namespace {

/// Twice the triangle's area along its normal; in double, so that tiny triangles keep a direction.
glm::dvec3 area_vector(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    return glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
}

glm::vec3 unit_or_z(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 ? glm::vec3(v / length) : glm::vec3(0.0f, 0.0f, 1.0f);
}

template <class T>
void gather(std::vector<T>& values, std::span<const std::uint32_t> indices, std::size_t width = 1) {
    if (values.empty()) return;
    std::vector<T> gathered;
    gathered.reserve(indices.size() * width);
    for (const std::uint32_t index : indices) {
        for (std::size_t k = 0; k < width; ++k) gathered.push_back(values[index * width + k]);
    }
    values = std::move(gathered);
}

/// New vertex i is the old vertex order[i], in all attributes and morph targets.
void gather_vertices(Primitive& primitive, std::span<const std::uint32_t> order) {
    gather(primitive.positions, order);
    gather(primitive.normals, order);
    gather(primitive.tangents, order);
    gather(primitive.texcoords[0], order);
    gather(primitive.texcoords[1], order);
    gather(primitive.colors, order);
    gather(primitive.joints, order, static_cast<std::size_t>(primitive.influences));
    gather(primitive.weights, order, static_cast<std::size_t>(primitive.influences));
    for (MorphTarget& target : primitive.targets) {
        gather(target.positions, order);
        gather(target.normals, order);
        gather(target.tangents, order);
    }
}

std::vector<glm::vec3> flat_normals(std::span<const glm::vec3> corners) {
    std::vector<glm::vec3> normals(corners.size());
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
        normals[i] = normals[i + 1] = normals[i + 2] =
            unit_or_z(area_vector(corners[i], corners[i + 1], corners[i + 2]));
    }
    return normals;
}

}  // namespace

std::vector<glm::vec3> smooth_normals(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices) {
    std::vector<glm::dvec3> sums(positions.size(), glm::dvec3(0.0));
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const auto a = indices[i], b = indices[i + 1], c = indices[i + 2];
        const glm::dvec3 area = area_vector(positions[a], positions[b], positions[c]);
        sums[a] += area;
        sums[b] += area;
        sums[c] += area;
    }
    std::vector<glm::vec3> normals(positions.size());
    for (std::size_t i = 0; i < sums.size(); ++i) normals[i] = unit_or_z(sums[i]);
    return normals;
}

void drop_unused_vertices(Primitive& primitive) {
    constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> numbers(primitive.positions.size(), kUnused), used;
    for (const std::uint32_t index : primitive.indices) numbers[index] = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (numbers[i] == kUnused) continue;
        numbers[i] = static_cast<std::uint32_t>(used.size());
        used.push_back(static_cast<std::uint32_t>(i));
    }
    if (used.size() == numbers.size()) return;
    gather_vertices(primitive, used);
    for (std::uint32_t& index : primitive.indices) index = numbers[index];
}

void make_flat(Primitive& primitive) {
    gather_vertices(primitive, std::vector<std::uint32_t>(primitive.indices));
    for (std::size_t i = 0; i < primitive.indices.size(); ++i) primitive.indices[i] = static_cast<std::uint32_t>(i);
    primitive.normals = flat_normals(primitive.positions);
    // Tangents belong to the normals that are missing.
    primitive.tangents.clear();
    for (MorphTarget& target : primitive.targets) {
        target.normals.clear();
        target.tangents.clear();
        if (target.positions.empty()) continue;
        // Exact with the target's weight at 1 and a straight blend in between.
        std::vector<glm::vec3> moved = primitive.positions;
        for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += target.positions[i];
        target.normals = flat_normals(moved);
        for (std::size_t i = 0; i < moved.size(); ++i) target.normals[i] -= primitive.normals[i];
    }
}

}  // namespace pentaprism
