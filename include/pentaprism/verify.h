#pragma once
// Every sample of a frame against an independent ray tracer, and a subset of them against brute force in double.

#include <cstdint>
#include <pentaprism/render.h>
#include <string>
#include <vector>

namespace pentaprism {

struct VerifyReport {
    std::string scene, reference;  ///< reference: "embree VERSION" and/or "brute force"
    int width = 0, height = 0, spp = 0;
    std::int64_t samples = 0;
    std::int64_t disagreements = 0;   ///< samples whose triangle or depth differ from the reference's
    double per_million = 0.0;         ///< ours_wrong in a million samples
    std::int64_t ours_wrong = 0;      ///< disagreements in which double precision is against us
    std::int64_t away_from_edge = 0;  ///< of them: over 1e-2 pixel from the nearest edge of each triangle concerned,
                                      ///< and depths that differ by over 1e-5 relative
    std::int64_t depth_ties = 0;      ///< disagreements on which of two surfaces is nearer that lie within 1e-6 of each
                                      ///< other (relative, in double), such as coplanar ones; not in ours_wrong
    double worst_margin = 0.0;  ///< largest such distance in pixels among ours_wrong whose depths differ so: over 1e-2
                                ///< exactly when away_from_edge is not 0
    double worst_depth_error = 0.0;        ///< largest relative depth error where both agree on the triangle
    std::int64_t brute_force_samples = 0;  ///< compared with the brute-force reference, too
    std::int64_t brute_force_disagreements = 0;
};

/// Renders frame `frame` and checks it. Throws Error(kBackend) when neither reference can be had.
VerifyReport verify_frame(const Scene& scene, const RenderSettings& settings, double frame,
                          const Progress& progress = {});

/// One configuration of Embree on a frame; the trace is judged by a part of the tiles.
struct PeerTrial {
    std::string peer;
    double build_ms = 0.0, trace_ms = 0.0;
};

/// Visibility alone, timed against Embree on the same samples: medians of alternating runs, milliseconds.
struct PeerTimes {
    std::string scene, peer;
    int width = 0, height = 0, spp = 0, threads = 0, runs = 0;
    double build_ms = 0.0, trace_ms = 0.0, ours_ms = 0.0;
    std::vector<PeerTrial> trials;  ///< what was tried before the fastest was chosen
    double ratio() const { return ours_ms > 0.0 ? (build_ms + trace_ms) / ours_ms : 0.0; }
};
/// `every_trial`: also what is not in the contest: robust mode, and a hierarchy that is refitted instead of built.
PeerTimes time_against_embree(const Scene& scene, const RenderSettings& settings, double frame, int runs,
                              bool every_trial = false);

}  // namespace pentaprism
