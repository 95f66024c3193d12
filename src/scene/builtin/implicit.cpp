#include "scene/builtin/implicit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>

namespace pentaprism::builtin {
namespace {

double limb_distance(const Limb& limb, glm::dvec3 p) {
    const glm::dvec3 axis = limb.b - limb.a;
    const double squared = glm::dot(axis, axis);
    const double t = squared > 0.0 ? std::clamp(glm::dot(p - limb.a, axis) / squared, 0.0, 1.0) : 0.0;
    return glm::length(p - limb.a - t * axis) - glm::mix(limb.ra, limb.rb, t);
}

double smooth_min(double a, double b, double k) {
    const double h = std::max(k - std::abs(a - b), 0.0) / k;
    return std::min(a, b) - 0.25 * h * h * k;
}

}  // namespace

double ImplicitBody::distance(glm::dvec3 p) const {
    constexpr double kFar = 1e9;
    std::array<double, 8> groups;  // the trunk (group 0) and what grows out of it
    groups.fill(kFar);
    for (const Limb& limb : limbs_) {
        double& d = groups[static_cast<std::size_t>(limb.group)];
        // Along a chain a full blend would swell every joint.
        d = smooth_min(d, limb_distance(limb, p), limb.group == 0 ? blend_ : 0.3 * blend_);
    }
    double nearest = groups[0];
    for (std::size_t i = 1; i < groups.size(); ++i)
        nearest = std::min(nearest, smooth_min(groups[0], groups[i], blend_));
    return nearest;
}

glm::dvec3 ImplicitBody::normal(glm::dvec3 p) const {
    const double h = 0.05 * blend_;
    const auto along = [&](glm::dvec3 e) { return distance(p + e) - distance(p - e); };
    return glm::normalize(glm::dvec3(along({h, 0, 0}), along({0, h, 0}), along({0, 0, h})) +
                          glm::dvec3(0.0, 1e-12, 0.0));
}

void ImplicitBody::dress(Primitive& mesh, glm::dvec3 p, bool skinned) const {
    glm::dvec3 color{0.0};
    double sum = 0.0;
    std::map<int, double> bones;
    const double nearest = distance(p);
    const auto closest = std::min_element(limbs_.begin(), limbs_.end(), [&](const Limb& a, const Limb& b) {
        return limb_distance(a, p) < limb_distance(b, p);
    });
    for (const Limb& limb : limbs_) {
        // A finger neither takes its neighbour's colour nor follows its bone.
        if (closest->group != 0 && limb.group != 0 && limb.group != closest->group) continue;
        const double x = (limb_distance(limb, p) - nearest) / blend_;
        const double weight = std::pow(std::max(0.0, 1.0 - 0.6 * x), 3) + 1e-9;
        color += weight * limb.color;
        sum += weight;
        bones[limb.bone] = std::max(bones[limb.bone], weight);
    }
    mesh.positions.emplace_back(p);
    mesh.normals.emplace_back(normal(p));
    mesh.colors.emplace_back(glm::vec4(glm::vec3(color / sum), 1.0f));
    if (!skinned) return;

    std::vector<std::pair<double, int>> ranked;
    for (const auto& [bone, weight] : bones) ranked.emplace_back(-weight, bone);
    std::sort(ranked.begin(), ranked.end());
    ranked.resize(std::max<std::size_t>(ranked.size(), 4), {0.0, 0});
    float total = 0.0f;
    for (int i = 0; i < 4; ++i) total += static_cast<float>(-ranked[std::size_t(i)].first);
    for (int i = 0; i < 4; ++i) {
        mesh.joints.push_back(static_cast<std::uint16_t>(ranked[std::size_t(i)].second));
        mesh.weights.push_back(static_cast<float>(-ranked[std::size_t(i)].first) / total);
    }
}

Primitive ImplicitBody::polygonize(double cell, Index material, bool skinned) const {
    glm::dvec3 low(std::numeric_limits<double>::max()), high(-low);
    for (const Limb& limb : limbs_) {
        low = glm::min(low, glm::min(limb.a - limb.ra, limb.b - limb.rb));
        high = glm::max(high, glm::max(limb.a + limb.ra, limb.b + limb.rb));
    }
    low -= blend_ + 2.0 * cell;
    high += blend_ + 2.0 * cell;
    const glm::ivec3 n{(high - low) / cell + 1.0};
    const auto at = [&](int x, int y, int z) { return std::size_t((z * n.y + y) * n.x + x); };
    const auto corner = [&](int x, int y, int z) { return low + cell * glm::dvec3(x, y, z); };

    std::vector<double> field(std::size_t(n.x) * std::size_t(n.y) * std::size_t(n.z));
    for (int z = 0; z < n.z; ++z)
        for (int y = 0; y < n.y; ++y) {
            // A distance field changes by at most the step walked, so points far from the surface are skipped over.
            for (int x = 0; x < n.x;) {
                const double d = distance(corner(x, y, z));
                const int skip = std::max(1, static_cast<int>((0.9 * std::abs(d) - 2.0 * cell) / cell));
                for (int i = 0; i < skip && x < n.x; ++i, ++x) field[at(x, y, z)] = d;
            }
        }

    Primitive mesh;
    mesh.material = material;
    mesh.influences = skinned ? 4 : 0;
    std::vector<std::uint32_t> vertex_of(field.size(), 0);
    for (int z = 0; z + 1 < n.z; ++z)
        for (int y = 0; y + 1 < n.y; ++y)
            for (int x = 0; x + 1 < n.x; ++x) {
                glm::dvec3 sum{0.0};
                int crossings = 0;
                for (int c = 0; c < 8; ++c)
                    for (int axis = 0; axis < 3; ++axis) {
                        if (c & (1 << axis)) continue;
                        const glm::ivec3 a{x + (c & 1), y + ((c >> 1) & 1), z + ((c >> 2) & 1)};
                        glm::ivec3 b = a;
                        ++b[axis];
                        const double da = field[at(a.x, a.y, a.z)], db = field[at(b.x, b.y, b.z)];
                        if ((da < 0.0) == (db < 0.0)) continue;
                        sum += glm::mix(corner(a.x, a.y, a.z), corner(b.x, b.y, b.z), da / (da - db));
                        ++crossings;
                    }
                if (crossings == 0) continue;
                glm::dvec3 p = sum / double(crossings);
                for (int i = 0; i < 3; ++i) p -= 0.8 * distance(p) * normal(p);
                vertex_of[at(x, y, z)] = static_cast<std::uint32_t>(mesh.positions.size());
                dress(mesh, p, skinned);
            }

    for (int z = 1; z + 1 < n.z; ++z)
        for (int y = 1; y + 1 < n.y; ++y)
            for (int x = 1; x + 1 < n.x; ++x)
                for (int axis = 0; axis < 3; ++axis) {
                    glm::ivec3 next{x, y, z};
                    ++next[axis];
                    const bool inside = field[at(x, y, z)] < 0.0;
                    if (inside == (field[at(next.x, next.y, next.z)] < 0.0)) continue;
                    // The four cells around this edge, in turn about the axis.
                    glm::ivec3 e1{0}, e2{0};
                    e1[(axis + 1) % 3] = 1;
                    e2[(axis + 2) % 3] = 1;
                    const glm::ivec3 p{x, y, z};
                    const auto cell_vertex = [&](glm::ivec3 q) { return vertex_of[at(q.x, q.y, q.z)]; };
                    std::array<std::uint32_t, 4> q{cell_vertex(p - e1 - e2), cell_vertex(p - e2), cell_vertex(p),
                                                   cell_vertex(p - e1)};
                    if (!inside) std::swap(q[1], q[3]);
                    mesh.indices.insert(mesh.indices.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
                }
    return mesh;
}

}  // namespace pentaprism::builtin
