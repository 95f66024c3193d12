// Visibility against Embree on the frames of cases.h, one row each: peer_table [RUNS [FILTER [THREADS]]]
//
// With PENTAPRISM_BENCH_TRIALS set to anything also each configuration of Embree that was tried, and what its robust
// mode and a refitted hierarchy would take.

#include <cstdlib>
#include <fmt/format.h>
#include <pentaprism/verify.h>

#include "cases.h"

int main(int argc, char** argv) {
    using namespace pentaprism;
    const int runs = argc > 1 ? std::atoi(argv[1]) : 3;
    const std::string filter = argc > 2 ? argv[2] : "";
    const int threads = argc > 3 ? std::atoi(argv[3]) : 1;
    const bool trials = std::getenv("PENTAPRISM_BENCH_TRIALS") != nullptr;
    for (const bench::Case& which : bench::cases()) {
        if (which.name.find(filter) == std::string::npos) continue;
        const Scene scene = load_scene(which.source);
        RenderSettings settings = bench::settings_for(which, scene);
        settings.method.threads = threads;
        const PeerTimes t = time_against_embree(scene, settings, which.frame, runs, trials);
        if (trials)
            for (const PeerTrial& trial : t.trials)
                fmt::print("    {:8.1f} + {:8.1f} ms  {}\n", trial.build_ms, trial.trace_ms, trial.peer);
        fmt::print("{:<22} {:8.1f} + {:8.1f} ms, ours {:7.1f} ms: ratio {:6.2f}  ({})\n", which.name, t.build_ms,
                   t.trace_ms, t.ours_ms, t.ratio(), t.peer);
        std::fflush(stdout);
    }
}
