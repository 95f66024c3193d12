#pragma once
// Optical vignetting: away from the middle of the picture the lens barrel hides a part of the lens, and highlights take
// the shape of a cat's eye. What is left is the part of the unit disk within a disk of the same size that is moved with
// the place in the picture (docs/develop/algorithms.md 10.6). Samples are not thrown away: they are moved into that
// part so that they are as dense everywhere in it, which keeps strata whole and the picture's brightness.

#include <glm/vec2.hpp>
#include <vector>

namespace pentaprism {

class CatsEye {
  public:
    CatsEye() = default;  ///< none
    /// `amount`: how far the second disk is moved for a corner of the picture, in lens radii, 0 to 1.5. `ratio`:
    /// Lens::ratio.
    CatsEye(double amount, int width, int height, double ratio);

    bool on() const { return amount_ > 0.0; }

    /// What is left of the lens for one place.
    class Outline {
      public:
        /// The lens point that a sample has instead of `uv`; both on the lens (v times ratio).
        glm::vec2 at(const glm::vec2& uv) const;

      private:
        friend class CatsEye;
        glm::dvec2 direction_{1.0, 0.0};  // of the move
        double move_ = 0.0, ratio_ = 1.0, between_ = 0.0;
        const double *across0_ = nullptr, *across1_ = nullptr;  // columns of the table for the next moves
    };
    /// Of (x, y) pixels from the picture's top left corner, y down.
    Outline outline(double x, double y) const;

  private:
    double amount_ = 0.0, width_ = 1.0, height_ = 1.0, ratio_ = 1.0;
    std::vector<double> across_;  // [move][sqrt(1 - |across|)]: where a sample goes, across the move
};

}  // namespace pentaprism
