#pragma once
// Who is right? Samples on which the renderer and a reference disagree are decided in double precision over the whole
// scene.

#include <cstdint>
#include <span>
#include <vector>

#include "peer/brute_force.h"

namespace pentaprism {

/// Depths within this of each other, relative, are called equal (docs/develop/verification.md).
inline constexpr double kDepthTolerance = 1e-5;
/// Two surfaces that double precision puts no further apart than this, relative, are a tie: the depths of a float test,
/// some 1e-7 to 1e-6 off, cannot tell which is nearer, so either may win.
inline constexpr double kDepthTie = 1e-6;
/// Pixels from an outline within which the rounding of a float test may decide.
inline constexpr double kEdgeTolerance = 1e-2;

/// What the renderer says of a sample.
struct Claim {
    int px = 0, py = 0, index = 0;
    std::uint32_t triangle = kNoTriangle;
    float depth = std::numeric_limits<float>::infinity();
};

struct Verdict {
    Claim claim;
    ExactHit truth;
    bool wrong = false;      ///< double precision is against the claim
    bool depth_tie = false;  ///< the claimed surface is another than the truth's, but no further off than kDepthTie
    double tie_gap = 0.0;    ///< of a depth tie: by how much, relative, the true surface is nearer in double
    double margin = 0.0;     ///< pixels to the nearest outline of the triangles concerned (claimed and true)
    double depth_difference = 0.0;  ///< relative, claimed against true depth; +infinity when one of them is no hit
    /// Beyond what the rounding of a float test explains: such a sample is a defect of the renderer.
    bool away_from_edge() const { return wrong && margin > kEdgeTolerance && depth_difference > kDepthTolerance; }
};

/// |a - b| / min(a, b) for depths: 0 when both are infinite, infinite when one of them is.
double relative_difference(double a, double b);

class Judge {
  public:
    /// Keeps a reference to the frame and the table. Costs 16 bytes a triangle.
    Judge(const Frame& frame, const SampleTable& table);

    /// One verdict for each claim, in order.
    std::vector<Verdict> judge(std::span<const Claim> claims) const;

    /// The verdict when the truth is known.
    Verdict compare(const Claim& claim, const ExactHit& truth) const;

  private:
    struct Box {
        float x0, x1, y0, y1;  // pixels from the middle of the picture, y up; empty: x0 > x1
    };
    Box bounds(std::uint32_t triangle) const;

    const Frame& frame_;
    const SampleTable& table_;
    std::vector<Box> boxes_;
};

}  // namespace pentaprism
