// Visibility against Embree on the frames of cases.h, one row each: bench_peers [RUNS [FILTER]]

#include <cstdlib>
#include <fmt/format.h>
#include <pentaprism/verify.h>

#include "cases.h"

int main(int argc, char** argv) {
    using namespace pentaprism;
    const int runs = argc > 1 ? std::atoi(argv[1]) : 3;
    const std::string filter = argc > 2 ? argv[2] : "";
    for (const bench::Case& which : bench::cases()) {
        if (which.name.find(filter) == std::string::npos) continue;
        const Scene scene = load_scene(which.source);
        const PeerTimes t = time_against_embree(scene, bench::settings_for(which, scene), which.frame, runs);
        fmt::print("{:<22} {:8.1f} + {:8.1f} ms, ours {:7.1f} ms: ratio {:6.2f}  ({})\n", which.name, t.build_ms,
                   t.trace_ms, t.ours_ms, t.ratio(), t.peer);
        std::fflush(stdout);
    }
}
