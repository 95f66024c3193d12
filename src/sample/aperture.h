#pragma once
// From the unit square to the lens: area-preserving, so uniform points stay uniform and strata stay connected.

#include <glm/vec2.hpp>

#include "camera/view.h"

namespace pentaprism {

/// (p, q) in [0, 1)^2 to (u, v) with |u| <= 1, |v| <= ratio. Disk: concentric map (Shirley & Chiu 1997). Blades: a
/// regular polygon with its corners on the unit circle; the disk's angle picks sector and place along its side, the
/// disk's radius the distance from the middle, which keeps areas. A picture: ApertureImage::point().
glm::dvec2 aperture_point(const Lens& lens, double p, double q);

}  // namespace pentaprism
