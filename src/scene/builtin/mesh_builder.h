#pragma once
// Appends shapes to one triangle mesh. Nearly every shape is a parametric surface p(u, v), tessellated on a grid, with
// normals from its derivatives; its front is the side of dp/du x dp/dv.

#include <functional>
#include <glm/mat4x4.hpp>
#include <pentaprism/scene.h>
#include <vector>

namespace pentaprism::builtin {

using Surface = std::function<glm::dvec3(double u, double v)>;
using Tint = std::function<glm::dvec3(double u, double v, glm::dvec3 p)>;

/// Centre line of a tube: points with radii.
struct TubePoint {
    glm::dvec3 p;
    double radius;
};

/// A blade: leaf, petal, grass. It starts at `base`, goes along `axis`, its face looks along `face` and bends towards
/// -face.
struct Blade {
    glm::dvec3 base{0.0}, axis{0.0, 1.0, 0.0}, face{0.0, 0.0, 1.0};
    double length = 1.0, width = 0.3;
    double bend = 0.0;    ///< radians from base to tip
    double fold = 0.0;    ///< radians that each half is raised about the midrib
    double widest = 0.4;  ///< where along the length it is widest
    int segments = 2;     ///< along the length; 4 * (segments - 1) triangles
};

class MeshBuilder {
  public:
    glm::dmat4 transform{1.0};  ///< applied to all that is appended from now on
    glm::dvec3 color{1.0};      ///< linear vertex colour of all that is appended without a tint of its own
    glm::dvec2 uv_scale{1.0};

    /// nu x nv quads over the unit square; corners that coincide (poles) make triangles.
    void surface(int nu, int nv, const Surface& p, const Tint& tint = {});

    /// Round cross-section along a smooth curve through the points. Texture: u around, v along. The ends are open,
    /// which no one sees when the last radius is near 0.
    void tube(const std::vector<TubePoint>& points, int around, int along, const Tint& tint = {});

    void ellipsoid(glm::dvec3 centre, glm::dvec3 radii, int around, int along, const Tint& tint = {});

    /// Rotates the profile (x = radius, y = height), smoothed through its points, about the y axis.
    void lathe(const std::vector<glm::dvec2>& profile, int around, int along, const Tint& tint = {});

    /// `tint` gets u across (0 to 1) and v along.
    void blade(const Blade& blade, const Tint& tint = {});

    /// Six faces with hard edges; each face has the whole texture.
    void box(glm::dvec3 low, glm::dvec3 high);

    std::uint32_t vertex(glm::dvec3 p, glm::dvec3 n, glm::dvec2 uv, glm::dvec3 vertex_color);
    void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);  ///< dropped when two corners coincide

    /// The finished mesh; the builder is empty afterwards.
    Primitive take(Index material);

  private:
    Primitive mesh_;
};

/// Point at t in [0, 1] of the Catmull-Rom spline (centripetal-free, uniform) through the points.
TubePoint along(const std::vector<TubePoint>& points, double t);

/// Two unit vectors that with `axis` form a right-handed frame: side x up = axis.
struct Frame {
    glm::dvec3 side, up;
};
Frame frame_around(glm::dvec3 axis);

}  // namespace pentaprism::builtin
