#pragma once
// A picture as the lens: light comes through where it is bright.

#include <glm/vec2.hpp>
#include <string>
#include <vector>

namespace pentaprism {

class ApertureImage {
  public:
    /// The lens is the largest circle (or ellipse) in the picture; pixels that are not whole inside let nothing
    /// through. `luminance`: rows from the top, width * height values; what is not finite or below 0 counts as 0.
    /// Throws Error(kUsage) when no light comes through. `name` is for the message.
    ApertureImage(int width, int height, const std::vector<float>& luminance, const std::string& name);

    /// (p, q) in [0, 1)^2 to the unit disk, v up, as dense as the picture is bright: rows by their light, then columns
    /// (inverse of the cumulated light, so neighbours stay neighbours and strata whole).
    glm::dvec2 point(double p, double q) const;

  private:
    int width_, height_;
    std::vector<double> rows_;     // light of the rows before each, 0 to 1: height + 1 values
    std::vector<double> columns_;  // of each row, of the columns before each, 0 to 1: width + 1 values a row
};

/// Reads an .exr or .png; luminance is multiplied by alpha. Throws Error(kUsage) with the option's name when it cannot
/// be read or lets no light through.
ApertureImage read_aperture_image(const std::string& file);

}  // namespace pentaprism
