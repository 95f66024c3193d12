// interval: a screen box for each cell of lens and shutter, 4 parts of the shutter times 2x2 of the lens.
//
// Known as Pixar's interval method; Fatahalian, Luong, Boulos, Akeley, Mark, Hanrahan 2009 (Data-Parallel Rasterization
// of Micropolygons with Defocus and Motion Blur) describe it. Within a cell the triangle is seen only in the box of
// docs/develop/algorithms.md 3.2 restricted to the cell's ranges (proof there); a sample is tested if its pixel or
// other footprint touches the box of its cell. The literature bounds x and w by intervals and divides; we take the box
// of the six points at the ends of the cell, which is tighter. A triangle that reaches the camera plane gets one box
// for all cells, the exact test's own. Few cells: cheap to set up, loose. interval_fine.cpp has more of them.
//
// Rounding: the box carries the slack of 4.2; cells are 1e-5 larger than the samples that belong to them.

#include "cull/cull_cells.h"

namespace pentaprism {
namespace {

using OurCells = Cells<4, 2>;

}  // namespace

extern const CullTest interval_test;
const CullTest interval_test{
    "interval",        "Fatahalian et al. 2009 (Pixar), 4 parts of the shutter times 2x2 of the lens",
    OurCells::prepare, OurCells::keeps,
    Grain::kPixel,     OurCells::begin};

}  // namespace pentaprism
