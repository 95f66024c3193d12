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

/// How fast limb_distance can change, per unit walked.
double steepness(const Limb& limb) {
    const double length = glm::length(limb.b - limb.a);
    return length > 0.0 ? std::sqrt(1.0 + std::pow((limb.ra - limb.rb) / length, 2.0)) : 1.0;
}

double smooth_min(double a, double b, double k) {
    const double h = std::max(k - std::abs(a - b), 0.0) / k;
    return std::min(a, b) - 0.25 * h * h * k;
}

}  // namespace

ImplicitBody::Near ImplicitBody::all() const {
    Near list;
    for (const Limb& limb : limbs_) list.push_back(&limb);
    return list;
}

// The limbs that can have a say anywhere within `reach` of `centre`: one that is farther than the nearest by more than
// the width of the blend changes nothing, since smooth_min is min there. Three widths, because blends add up.
ImplicitBody::Near ImplicitBody::near(glm::dvec3 centre, double reach) const {
    double nearest = std::numeric_limits<double>::max();
    for (const Limb& limb : limbs_) nearest = std::min(nearest, limb_distance(limb, centre) + steepness(limb) * reach);
    Near list;
    for (const Limb& limb : limbs_)
        if (limb_distance(limb, centre) - steepness(limb) * reach <= nearest + 3.0 * blend_) list.push_back(&limb);
    return list;
}

double ImplicitBody::distance(const Near& limbs, glm::dvec3 p) const {
    constexpr double kFar = 1e9;
    std::array<double, 8> groups;  // the trunk (group 0) and what grows out of it
    groups.fill(kFar);
    for (const Limb* limb : limbs) {
        double& d = groups[static_cast<std::size_t>(limb->group)];
        // Along a chain a full blend would swell every joint.
        d = smooth_min(d, limb_distance(*limb, p), limb->group == 0 ? blend_ : 0.3 * blend_);
    }
    double nearest = groups[0];
    for (std::size_t i = 1; i < groups.size(); ++i)
        nearest = std::min(nearest, smooth_min(groups[0], groups[i], blend_));
    return nearest;
}

glm::dvec3 ImplicitBody::normal(const Near& limbs, glm::dvec3 p) const {
    const double h = 0.05 * blend_;
    const auto along = [&](glm::dvec3 e) { return distance(limbs, p + e) - distance(limbs, p - e); };
    return glm::normalize(glm::dvec3(along({h, 0, 0}), along({0, h, 0}), along({0, 0, h})) +
                          glm::dvec3(0.0, 1e-12, 0.0));
}

void ImplicitBody::dress(Primitive& mesh, const Near& limbs, glm::dvec3 p, bool skinned) const {
    glm::dvec3 color{0.0};
    double sum = 0.0;
    std::map<int, double> bones;
    const double nearest = distance(limbs, p);
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
    mesh.normals.emplace_back(normal(limbs, p));
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

    // Blocks of cells know the limbs near them, and those that the surface does not pass by need only a sign.
    constexpr int kBlock = 8;
    const glm::ivec3 blocks = (n + kBlock - 1) / kBlock;
    const auto block_of = [&](int x, int y, int z) {
        return std::size_t((z / kBlock * blocks.y + y / kBlock) * blocks.x + x / kBlock);
    };
    double steepest = 1.0;
    for (const Limb& limb : limbs_) steepest = std::max(steepest, steepness(limb));
    const double reach = (0.5 * std::sqrt(3.0) * kBlock + 4.0) * cell + 0.1 * blend_;
    std::vector<double> field(std::size_t(n.x) * std::size_t(n.y) * std::size_t(n.z));
    std::vector<Near> limbs_of_block(std::size_t(blocks.x) * std::size_t(blocks.y) * std::size_t(blocks.z));
    for (int bz = 0; bz < n.z; bz += kBlock)
        for (int by = 0; by < n.y; by += kBlock)
            for (int bx = 0; bx < n.x; bx += kBlock) {
                const glm::dvec3 middle = corner(bx, by, bz) + glm::dvec3(0.5 * kBlock * cell);
                Near& limbs = limbs_of_block[block_of(bx, by, bz)];
                limbs = near(middle, reach);
                const double there = distance(limbs, middle);
                const bool passes = std::abs(there) <= steepest * reach;
                if (!passes) limbs.clear();
                for (int z = bz; z < std::min(bz + kBlock, n.z); ++z)
                    for (int y = by; y < std::min(by + kBlock, n.y); ++y)
                        for (int x = bx; x < std::min(bx + kBlock, n.x); ++x)
                            field[at(x, y, z)] = passes ? distance(limbs, corner(x, y, z)) : there;
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
                const Near& limbs = limbs_of_block[block_of(x, y, z)];
                for (int i = 0; i < 3; ++i) p -= 0.8 * distance(limbs, p) * normal(limbs, p);
                vertex_of[at(x, y, z)] = static_cast<std::uint32_t>(mesh.positions.size());
                dress(mesh, limbs, p, skinned);
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
