#pragma once
// What a frame cost.

#include <cstdint>
#include <map>
#include <string>

namespace pentaprism {

struct RenderStats {
    std::map<std::string, double>
        times_ms;                ///< by stage; "visibility" is bound + bin + cull + cover, all threads' wall time
    std::int64_t triangles = 0;  ///< of the frame (a triangle counts once, however many motion segments it has)
    std::int64_t moving_triangles = 0;  ///< triangles times their motion segments
    std::int64_t samples = 0;           ///< of the picture: width * height * spp, or what a target error gave
    std::int64_t pilot_samples = 0;     ///< not shown: they decide how many each pixel gets
    std::int64_t pixels = 0;
    std::int64_t tested = 0;   ///< exact 5D coverage tests
    std::int64_t covered = 0;  ///< of them accepted
    std::int64_t shaded = 0;   ///< shading evaluations
    double peak_mb = 0.0;      ///< largest resident memory of the process so far
    int threads = 0;
    std::string isa;          ///< avx512, avx2, neon or scalar
    std::string device;       ///< of Backend::kGl, as its driver calls it; else empty
    std::string gl_pipeline;  ///< of Backend::kGl what GlPipeline::kAuto chose: geometry or compute; else empty

    /// Sample test efficiency: covered / tested, 0 when nothing was tested.
    double ste() const { return tested ? static_cast<double>(covered) / static_cast<double>(tested) : 0.0; }
};

}  // namespace pentaprism
