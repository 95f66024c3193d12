#include "peer/reference.h"

#include <pentaprism/error.h>

#ifdef PENTAPRISM_HAVE_EMBREE
#include "peer/embree_reference.h"
#endif

namespace pentaprism {

Reference make_reference([[maybe_unused]] const Frame& frame, [[maybe_unused]] const SampleTable& table) {
#ifdef PENTAPRISM_HAVE_EMBREE
    try {
        const auto embree = std::make_shared<const EmbreeReference>(frame, table, EmbreeOptions{});
        return {embree_version(), [embree](const Tile& tile, Hits& hits) { embree->trace(tile, hits); }};
    } catch (const Error&) {
        return {};
    }
#else
    return {};
#endif
}

}  // namespace pentaprism
