#include "resolve/surface_samples.h"

#include <algorithm>
#include <cmath>

namespace pentaprism {
namespace {

constexpr std::size_t kEntries = 1024;

// Rounding, and slivers' samples, may lie just outside.
glm::vec3 inside(const Float4& b) {
    const glm::vec3 kept(std::max(b[0], 0.0f), std::max(b[1], 0.0f), std::max(b[2], 0.0f));
    const float sum = kept.x + kept.y + kept.z;
    return std::isfinite(sum) && sum > 0.0f ? kept / sum : glm::vec3(1.0f / 3.0f);
}

}  // namespace

void SurfaceSamples::start(const ShadingScene& scene, const Tile& tile) {
    scene_ = &scene;
    centre_ = cell_centre(scene.frame().view, tile.cell_x(), tile.cell_y());
    entries_.assign(kEntries, Entry{});
}

const SurfaceSamples::Entry& SurfaceSamples::entry(std::uint32_t triangle, int segment) {
    Entry& e = entries_[(triangle * 31u + static_cast<std::uint32_t>(segment)) % kEntries];
    if (e.triangle != triangle || e.segment != segment) {
        e.triangle = triangle;
        e.segment = segment;
        e.local = localize(scene_->frame(), triangle, segment, centre_);
        e.lanes = CornerLanes(e.local);
    }
    return e;
}

SurfaceSample SurfaceSamples::at(std::uint32_t triangle, float depth, const LocalSample& sample) {
    const Frame& frame = scene_->frame();
    const std::uint32_t part_index = frame.part_of[triangle];
    const Part& part = frame.parts[part_index];
    const int segment = std::min(static_cast<int>(sample.t * static_cast<float>(part.segments)), part.segments - 1);
    const Entry& e = entry(triangle, part.moves ? segment : 0);
    const Seen seen = project(e.lanes, sample);

    SurfaceSample s;
    s.part_index = part_index;
    s.part = &part;
    s.shaded = &scene_->part_of(triangle);
    s.vertices = frame.vertices(triangle);
    s.barycentrics = inside(seen.barycentrics);
    s.front = seen.front;
    s.depth = depth;
    s.t = sample.t;
    // Both c and w are linear over the triangle in clip space.
    const float tau = sample.t * e.local.segments - e.local.segment;
    float c = 0, w = 0;
    for (int i = 0; i < 3; ++i) {
        c += s.barycentrics[i] * (e.local.qc[i] + tau * e.local.dc[i]);
        w += s.barycentrics[i] * (e.local.qw[i] + tau * e.local.dw[i]);
    }
    s.coc = w > 0.0f ? c / w : 0.0f;
    s.barycentrics = frame.in_source(triangle, s.barycentrics);
    return s;
}

}  // namespace pentaprism
