#pragma once
// Smooth bodies: capsules of varying radius that melt into each other, and their surface as triangles.
// The blend is the polynomial smooth minimum (Quilez, "Smooth minimum"); the mesher is naive surface nets (Gibson 1998,
// "Constrained Elastic Surface Nets", in the form of one vertex for each cell at the mean of its edges' crossings),
// here with the vertices moved onto the surface by Newton steps instead of relaxation.

#include <glm/vec3.hpp>
#include <pentaprism/scene.h>
#include <vector>

namespace pentaprism::builtin {

/// A cone from a (radius ra) to b (radius rb) with round ends.
struct Limb {
    glm::dvec3 a, b;
    double ra, rb;
    glm::dvec3 color{1.0};
    int group = 0;  ///< limbs of different groups (> 0) do not melt into each other, only into group 0
    int bone = 0;   ///< joint that moves it
};

class ImplicitBody {
  public:
    ImplicitBody(std::vector<Limb> limbs, double blend) : limbs_(std::move(limbs)), blend_(blend) {}

    double distance(glm::dvec3 p) const { return distance(all(), p); }  ///< negative inside
    glm::dvec3 normal(glm::dvec3 p) const { return normal(all(), p); }

    /// Vertex colours melt like the shape. With `skinned`, each vertex follows its four nearest bones.
    Primitive polygonize(double cell, Index material, bool skinned) const;

  private:
    using Near = std::vector<const Limb*>;

    Near all() const;
    Near near(glm::dvec3 centre, double reach) const;
    double distance(const Near& limbs, glm::dvec3 p) const;
    glm::dvec3 normal(const Near& limbs, glm::dvec3 p) const;
    void dress(Primitive& mesh, const Near& limbs, glm::dvec3 p, bool skinned) const;

    std::vector<Limb> limbs_;
    double blend_;
};

}  // namespace pentaprism::builtin
