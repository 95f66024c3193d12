#pragma once
// Reconstruction filters: separable, h(dx) * h(dy) of the distance from a pixel's centre in pixels
// (docs/learn/shading.md).

#include <pentaprism/settings.h>

namespace pentaprism {

/// 0.5 (box), 1 (tent), 1.5 (gaussian, blackman-harris) pixels.
double filter_radius(Filter filter);

/// h(d); 0 from the radius on, except the box, which is 1 up to 0.5 inclusive: a sample on a pixel's border is one of
/// its own.
double filter_weight(Filter filter, double d);

/// How many pixels away a pixel's samples still count: 0 for the box, else 1.
int filter_reach(Filter filter);

}  // namespace pentaprism
