#pragma once
// Estimators of a pixel that use a triangle's bounds in lens and time to place its samples, right and wrong
// (docs/learn/guided-sampling.md).

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "bin/bins.h"
#include "bound/local_triangle.h"
#include "cull/cull_test.h"

namespace pentaprism {

enum class Guidance {
    kUnguided,    ///< one set of samples for all triangles, each tested against all
    kEnumerated,  ///< the same samples, each tested against the triangles whose bounds hold it
    kPrivate,     ///< each triangle has samples of its own, all inside its bounds, and a z-buffer compares them: BIASED
    kStrata,      ///< one set of samples, denser where more bounds overlap, each with its weight
    kTraced  ///< each triangle's own samples, but each of them looks for the nearest triangle at its (x, y, u, v, t)
};

/// Cells of lens and shutter: 8 intervals of time times the 4 quadrants of the lens, all of equal probability.
inline constexpr int kGuideCells = 32;

/// A triangle that a pixel may see, and in which cells: bit time * 4 + quadrant.
struct Candidate {
    const LocalTriangle* triangle;
    std::uint32_t cells;
};

/// What one pixel's candidates are.
struct GuidedPixel {
    int px = 0, py = 0;
    CellCentre centre{};
    std::vector<Candidate> candidates;
};

class GuidedSampler {
  public:
    /// `colors`: of each triangle of the frame. The frame must outlive it; its aperture is taken for a disk.
    GuidedSampler(const Frame& frame, std::vector<glm::vec3> colors, const glm::vec3& background);

    /// The candidates of the pixels of cell (cx, cy), by row and column in the cell; bounded by the improved dual-space
    /// test over each cell of lens and shutter. Triangles live as long as the returned object.
    struct Cell {
        std::vector<LocalTriangle> triangles;
        std::vector<GuidedPixel> pixels;
    };
    Cell bound(int cx, int cy) const;

    /// The pixel's colour from `samples` samples (kTraced and kPrivate: as many of each triangle as its bounds' share).
    /// A pure function of its arguments. `tests` grows by the number of exact tests.
    glm::dvec3 estimate(Guidance guidance, const GuidedPixel& pixel, int samples, std::uint32_t seed,
                        std::int64_t& tests) const;

  private:
    class Draw;
    const Frame& frame_;
    std::vector<glm::vec3> colors_;
    glm::vec3 background_;
    Bins bins_;
};

}  // namespace pentaprism
