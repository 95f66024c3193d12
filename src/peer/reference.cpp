#include "peer/reference.h"

#include <pentaprism/error.h>

#include "trace/tracer.h"

namespace pentaprism {

Reference make_reference(const Frame& frame, const SampleTable& table) {
    try {
        const std::shared_ptr<const Tracer> tracer = make_tracer(frame, table);
        return {tracer_name(), [tracer](const Tile& tile, Hits& hits) { tracer->trace(tile, hits); }};
    } catch (const Error&) {
        return {};
    }
}

}  // namespace pentaprism
