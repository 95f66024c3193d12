#pragma once
// How the vertices of a placement move while the shutter is open, and how many straight pieces follow their paths.

#include <cstdint>
#include <glm/vec4.hpp>
#include <map>
#include <vector>

#include "base/uninitialized.h"
#include "frame/clip_block.h"
#include "frame/moments.h"

namespace pentaprism {

/// The vertices at the knots of straight pieces: x, y, w, c in raster clip space, knot after knot; `depths` has z of an
/// orthographic camera's (else z = w).
struct KnotVertices {
    UninitializedVector<glm::vec4> points;
    UninitializedVector<float> depths;
};

/// Of one placement. Not for several threads, but uses them.
class VertexPaths {
  public:
    VertexPaths(const Scene& scene, const View& view, const Placement& placement, Moments& moments);

    /// As far as the quarters of the shutter tell.
    bool stand_still();

    /// The least number of pieces, a power of two up to 64, that keeps all vertices within 0.1 pixel of their paths;
    /// their knots. Errors are asked at the quarters of each piece: at the middle alone, an S-shaped path would look
    /// straight.
    int straight_pieces(KnotVertices& knots);

    /// At pieces + 1 even times, or with 0 pieces at time 0 alone.
    void at_knots(int pieces, KnotVertices& knots);

  private:
    // What vertices are computed from at one time.
    struct Instant {
        Instant(const Scene& scene, const Placement& placement, const Moment& at);
        const Moment& moment;
        PlacedVertices vertices;
        glm::dmat4 matrix;  // of a rigid placement
    };

    const Instant& at(double t);
    std::vector<const Instant*> at_quarters(int pieces);
    PointBlock positions(std::size_t first) const;
    void compute(const Instant& instant, std::size_t first, const PointBlock& local, ClipBlock& out) const;
    void make_room(std::size_t knot_count, KnotVertices& knots) const;
    void store(const ClipBlock& block, std::size_t first, std::size_t knot, KnotVertices& knots) const;
    bool follow(const std::vector<const Instant*>& times, std::size_t first, KnotVertices& knots) const;
    template <class Body>
    void for_each_block(const Body& body) const;

    const Scene& scene_;
    const View& view_;
    Placement placement_;
    Moments& moments_;
    const Primitive& primitive_;
    bool rigid_;
    ClipKernels kernels_;
    std::map<double, Instant> instants_;
};

}  // namespace pentaprism
