#include <algorithm>
#include <pentaprism/verify.h>

#include "base/parallel.h"
#include "peer/posed_picture.h"
#include "peer/reference.h"
#include "render/visibility.h"

namespace pentaprism {
namespace {

/// Brute force costs samples times triangles: some seconds' worth, but never so few samples that it says nothing.
std::int64_t brute_force_budget(const Frame& frame) {
    constexpr std::int64_t kTests = 400'000'000, kMost = 20'000, kFewest = 200;
    return std::clamp(kTests / std::max<std::int64_t>(frame.triangle_count(), 1), kFewest, kMost);
}

}  // namespace

VerifyReport verify_frame(const Scene& scene, const RenderSettings& settings, double frame, const Progress& progress) {
    set_thread_count(settings.method.threads);
    const PosedPicture picture = pose_picture(scene, settings, frame);
    const View& view = picture.frame.view;
    const Visibility visibility(picture.frame, picture.samples, settings.method, {0, view.width, 0, view.height});
    const TileTracer ours = [&](const Tile& tile, Hits& hits) {
        CoverCounts counts;
        visibility.cover(tile, hits, counts);
    };
    const Reference reference = make_reference(picture.frame, picture.samples);

    CompareOptions options;
    options.tile_size = settings.method.tile_size;
    options.brute_force_samples = brute_force_budget(picture.frame);
    VerifyReport report = compare_tracers(picture.frame, picture.samples, ours, reference.tracer, options, progress);
    report.scene = scene.name;
    report.reference = reference.name.empty() ? "brute force" : reference.name + " and brute force";
    return report;
}

}  // namespace pentaprism
