// interval: a screen box for each cell of lens and shutter, 4 parts of the shutter times 2x2 of the lens. Few cells:
// cheap to set up, loose. cull_cells.h has the method, its source and what we do otherwise; interval_fine.cpp has more
// cells.

#include "cull/cull_cells.h"

namespace pentaprism {

extern const CullTest interval_test;
const CullTest interval_test =
    Cells<4, 2>::test("interval", "Fatahalian et al. 2009 (Pixar), 4 parts of the shutter times 2x2 of the lens");

}  // namespace pentaprism
