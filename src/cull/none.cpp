// none: keeps everything within the screen bounds ("bounding box scan"). What every other test is measured against.

#include "cull/cull_test.h"

namespace pentaprism {

extern const CullTest none_test;
const CullTest none_test{"none", "the bounding box alone", keeps_every_footprint, keeps_every_sample};

}  // namespace pentaprism
