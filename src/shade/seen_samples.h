#pragma once
// What the samples of a triangle see of it: barycentrics by the formulas of the exact test (cover/exact.h), and the
// shading cell in which that point lies, sixteen samples at a time.
//
// Whether the samples are covered is decided already; here speed counts, and the last bit does not: sums of products
// are not fused, so that all CPU targets give the same bits.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "base/aligned.h"
#include "bound/local_triangle.h"
#include "shade/tile_samples.h"

namespace pentaprism {

/// A piece of a triangle that is shaded once: a rectangle on the screen as seen at mid-shutter through the middle of
/// the lens, where motion and lens do not blur; larger where they do, as what is blurred holds no detail (after
/// Vaidyanathan, Toth, Salvi, Boulos, Lefohn 2012; here for each material point). Sides are the power of two nearest to
/// a quarter of the blur, along the motion and across it, and no less than a pixel: the grid of pixels itself where
/// there is no blur.
struct ShadingCell {
    glm::dvec2 centre{0.0};                           ///< pixels from the middle of the picture, y up
    glm::vec2 along{1.0f, 0.0f}, across{0.0f, 1.0f};  ///< sides, pixels
};

/// Which cell a sample sees, and from which side. Equal keys, equal cells.
struct CellKey {
    static constexpr std::uint32_t kFront = 1, kAlone = 1u << 31;
    std::uint32_t kind = 0;   ///< kFront, and the cell's size and direction; kAlone: no cell, shaded by itself
    std::uint32_t place = 0;  ///< column and row in the grid of its kind
    bool front() const { return (kind & kFront) != 0; }
    bool alone() const { return (kind & kAlone) != 0; }
    bool operator==(const CellKey&) const = default;
    ShadingCell cell() const;  ///< not of a sample that is alone
};

/// A triangle on the screen as cells see it: pixels from the middle of the picture, at mid-shutter and through the
/// middle of the lens. [corner]
struct CellTriangle {
    float x[3], y[3], w[3], coc[3];
    float motion_x[3], motion_y[3], motion_w[3];  ///< over the whole shutter
    float w_near = 0.0f;                          ///< nearer points have no cell
};

/// Directions of cells: of half a turn, and the borders between them.
struct CellDirections {
    static constexpr int kCount = 16;
    float cosine[kCount], sine[kCount], border_cosine[kCount], border_sine[kCount];
};
const CellDirections& cell_directions();

/// Keeps its memory; one for each thread.
class SeenSamples {
  public:
    /// For samples of one cell of the picture's grid. All must outlive what follows. No side of a shading cell is less
    /// than 2^least_level pixels; at most 6.
    void start(const Frame& frame, const CellCentre& centre, int least_level = 0);

    /// `samples` hit the triangle, and outlive what follows. `cells`: null if no cells are wanted.
    void see(std::uint32_t triangle, const SampleRun& samples, const CellTriangle* cells);

    /// Of the i-th of them. Barycentrics lie inside the triangle; of one that is seen edge-on they are its middle's.
    glm::vec3 barycentrics(std::size_t i) const { return {b_[0][i], b_[1][i], b_[2][i]}; }
    CellKey key(std::size_t i) const { return {kind_[i], place_[i]}; }

    // Sixteen of them, for the vector code; the arrays it writes are aligned.
    struct Batch {
        const Float4* xyuv;
        const float* t;
        const std::uint32_t* places;
        const LocalTriangle* const* triangles;  // of the segments to which their times belong
        int triangle_count;
        const CellTriangle* cells;
        int least_level;
        float* b[3];
        std::uint32_t *kind, *place;
    };

  private:
    const LocalTriangle& local(int segment);

    void (*see_batch_)(const Batch&) = nullptr;  // of the CPU target

    const Frame* frame_ = nullptr;
    CellCentre centre_{0.0f, 0.0f};
    int least_level_ = 0;
    std::uint32_t triangle_ = 0;
    std::vector<LocalTriangle> locals_;  // of each segment
    std::vector<std::uint8_t> ready_;
    AlignedVector<float> b_[3];
    AlignedVector<std::uint32_t> kind_, place_;
};

}  // namespace pentaprism
