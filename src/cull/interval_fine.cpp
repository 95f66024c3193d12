// interval-fine: a screen box for each cell of lens and shutter, 16 parts of the shutter times 4x4 of the lens. Many
// cells: close to the samples' own bounds, dear to set up for a small triangle. cull_cells.h has the method, its source
// and what we do otherwise; interval.cpp has fewer cells.

#include "cull/cull_cells.h"

namespace pentaprism {

extern const CullTest interval_fine_test;
const CullTest interval_fine_test = Cells<16, 4>::test(
    "interval-fine", "Fatahalian et al. 2009 (Pixar), 16 parts of the shutter times 4x4 of the lens");

}  // namespace pentaprism
