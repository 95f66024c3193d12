// none: keeps everything within the screen bounds ("bounding box scan"). What every other test is measured against.

#include "cull/cull_test.h"

namespace pentaprism {
namespace {

bool prepare(const LocalTriangle&, const Footprint&, CullState&) {
    return true;
}
bool keeps(const CullState&, const LocalSample&) {
    return true;
}

}  // namespace

extern const CullTest none_test;
const CullTest none_test{"none", "the bounding box alone", prepare, keeps};

}  // namespace pentaprism
