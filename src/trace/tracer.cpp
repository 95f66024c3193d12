#include "trace/tracer.h"

#include <pentaprism/error.h>

#ifdef PENTAPRISM_HAVE_EMBREE
#include "trace/embree_tracer.h"
#endif

namespace pentaprism {

#ifdef PENTAPRISM_HAVE_EMBREE

std::unique_ptr<const Tracer> make_tracer(const Frame& frame, const SampleTable& table) {
    return std::make_unique<const EmbreeTracer>(frame, table, EmbreeOptions{});
}

std::string tracer_name() {
    return embree_version();
}

#else

std::unique_ptr<const Tracer> make_tracer(const Frame&, const SampleTable&) {
    throw Error(ErrorKind::kBackend,
                "this build has no Embree to trace rays with; install libembree-dev and build again");
}

std::string tracer_name() {
    return {};
}

#endif

}  // namespace pentaprism
