// bbox: all samples in the triangle's screen bounds, the fifteen-edge box of docs/develop/algorithms.md 3.2, which
// every other test starts from, too. `none` by its name in the literature: "bounding box scan".
//
// McGuire, Enderton, Shirley, Luebke 2010, Real-Time Stochastic Rasterization on Conventional GPU Architectures
// (conjectured; 3.2 has the proof); Akenine-Moller, Munkberg, Hasselgren 2007 use boxes, too. The box is worked out
// when triangles are sorted into tiles (bound/screen_bounds.h), so nothing is left to ask.

#include "cull/cull_test.h"

namespace pentaprism {

extern const CullTest bbox_test;
const CullTest bbox_test{"bbox", "McGuire, Enderton, Shirley, Luebke 2010, fifteen-edge box", keeps_every_footprint,
                         keeps_every_sample};

}  // namespace pentaprism
