#pragma once
// The upper three rows of a matrix: what moves a point. Inline, for a skin blends one for every vertex.

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

namespace pentaprism {

struct Affine {
    double column[12] = {};  ///< x, y, z and origin, one after the other: added up as one array

    Affine() = default;
    explicit Affine(const glm::dmat4& m) {
        for (int c = 0; c < 4; ++c)
            for (int row = 0; row < 3; ++row) column[3 * c + row] = m[c][row];
    }

    void add(const Affine& other, double weight) {
        for (int i = 0; i < 12; ++i) column[i] += weight * other.column[i];
    }

    glm::dvec3 x() const { return {column[0], column[1], column[2]}; }
    glm::dvec3 y() const { return {column[3], column[4], column[5]}; }
    glm::dvec3 z() const { return {column[6], column[7], column[8]}; }
    glm::dvec3 origin() const { return {column[9], column[10], column[11]}; }

    glm::dvec3 vector(const glm::dvec3& v) const { return x() * v.x + y() * v.y + z() * v.z; }
    glm::dvec3 point(const glm::dvec3& p) const { return vector(p) + origin(); }

    /// Where a surface's normal points: the cofactors are the inverse transpose times the determinant, defined even
    /// without an inverse.
    glm::dvec3 normal(const glm::dvec3& n) const {
        const glm::dvec3 yz = glm::cross(y(), z()), zx = glm::cross(z(), x()), xy = glm::cross(x(), y());
        const double sign = glm::dot(x(), yz) < 0.0 ? -1.0 : 1.0;
        return sign * (yz * n.x + zx * n.y + xy * n.z);
    }
};

}  // namespace pentaprism
