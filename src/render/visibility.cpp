#include "render/visibility.h"

#include <algorithm>
#include <pentaprism/error.h>

#include "frame/opacity.h"

namespace pentaprism {
namespace {

SamplePattern pattern_for(VisibilityMethod method) {
    switch (method) {
        case VisibilityMethod::kAccumulation:
            return SamplePattern::kAccumulation;
        case VisibilityMethod::kInterleaved:
            return SamplePattern::kInterleaved;
        default:
            return SamplePattern::kFree;
    }
}

}  // namespace

Grouping grouping_for(const Frame& frame) {
    const bool motion =
        std::any_of(frame.parts.begin(), frame.parts.end(), [](const Part& part) { return part.moves; });
    const bool defocus = !frame.view.lens.pinhole();
    return motion ? (defocus ? Grouping::kBoth : Grouping::kMotion) : (defocus ? Grouping::kDefocus : Grouping::kStill);
}

SampleTable make_samples(const Frame& frame, int spp, const MethodSettings& method) {
    if (frame.view.lens.cats_eye > 0.0 && pattern_for(method.visibility) != SamplePattern::kFree)
        throw Error(ErrorKind::kUsage,
                    "the camera has a cat's eye, but with --visibility accumulation and interleaved all places share "
                    "their lens points; give --cats-eye 0");
    return SampleTable(spp, method.seed, frame.view.lens, grouping_for(frame), pattern_for(method.visibility),
                       SampleTimes(frame.view.shutter, frame.view.width, frame.view.height),
                       CatsEye(frame.view.lens.cats_eye, frame.view.width, frame.view.height, frame.view.lens.ratio),
                       method.sampler);
}

std::vector<Tile> tiles_over(const PixelRect& limits, int size) {
    std::vector<Tile> tiles;
    for (int y = limits.y0 / size * size; y < limits.y1; y += size)
        for (int x = limits.x0 / size * size; x < limits.x1; x += size)
            tiles.push_back({x, y, std::min(x + size, limits.x1), std::min(y + size, limits.y1)});
    return tiles;
}

Visibility::Visibility(const Frame& frame, const SampleTable& samples, const MethodSettings& method,
                       const PixelRect& limits)
    : frame_(frame),
      samples_(samples),
      method_(method.visibility),
      blurs_(grouping_for(frame) != Grouping::kStill),
      culling_(method.culling == "auto" ? Culling() : parse_culling(method.culling)) {
    if (method.backend == Backend::kGl)
        rasterizer_ = make_gl_rasterizer(frame, samples, method, limits);
    else if (method_ == VisibilityMethod::kRaytrace)
        tracer_ = make_tracer(frame, samples);
    else
        bins_.emplace(frame, method.tile_size, limits);
    tiles_ = tiles_over(limits, method.tile_size);
}

void Visibility::cover(const Tile& tile, const SampleTable& samples, Hits& hits, CoverCounts& counts,
                       CoverMap* map) const {
    hits.reset(samples.slots(), tile);
    if (tracer_) return tracer_->trace(tile, hits);
    if (rasterizer_) return rasterizer_->cover(tile, hits, counts, map);
    const TileWork work{frame_, samples, bins_->triangles(), bins_->tile(tile.x0, tile.y0), tile, map};
    cover_list(work, hits, counts);
}

void Visibility::cover_list(const TileWork& work, Hits& hits, CoverCounts& counts) const {
    if (method_ == VisibilityMethod::kMicropolygon)
        cover_micropolygons(work, hits, counts);
    else if (!culling_.empty())
        cover_with_test(work, culling_, hits, counts);
    else if (work.samples.pattern() != SamplePattern::kFree)
        cover_shared(work, hits, counts);
    else if (!blurs_ && !work.samples.by_pixel(0, 0).x.empty())
        cover_still(work, hits, counts);
    else
        cover_vectors(work, hits, counts);
}

// Of the tile's triangles those that are, or are not, see-through.
std::vector<std::uint32_t> Visibility::see_through(const Tile& tile, bool wanted) const {
    std::vector<std::uint32_t> list;
    for (const std::uint32_t entry : bins_->tile(tile.x0, tile.y0))
        if (is_see_through(frame_, bins_->triangles()[entry].triangle) == wanted) list.push_back(entry);
    return list;
}

void Visibility::cover_solid(const Tile& tile, const SampleTable& samples, Hits& hits, CoverCounts& counts) const {
    const std::vector<std::uint32_t> list = see_through(tile, false);
    hits.reset(samples.slots(), tile);
    cover_list({frame_, samples, bins_->triangles(), list, tile, nullptr}, hits, counts);
}

void Visibility::cover_layers(const Tile& tile, const SampleTable& samples, const Hits& solid, Layers& layers,
                              CoverCounts& counts) const {
    const std::vector<std::uint32_t> list = see_through(tile, true);
    const Culling culling = culling_.empty() ? parse_culling("improved-dual-space") : culling_;
    pentaprism::cover_layers({frame_, samples, bins_->triangles(), list, tile, nullptr}, culling, solid, layers,
                             counts);
}

}  // namespace pentaprism
