#include "shade/shade_tile.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "bound/local_triangle.h"
#include "sample/net.h"

namespace pentaprism {
namespace {

// A point belongs to one pixel, so a tile may be shaded in pieces of whole blocks: memory stays bounded at 4096 samples
// a pixel.
constexpr int kSamplesPerChunk = 1 << 16;
constexpr int kQuarters = QuarterColors::kQuarters;
constexpr int kLookups = ShadowPoint::kLanes / kQuarters;  // of a quarter
constexpr int kRoughLevel = 2;                             // 2^2 = kBlockSize
void write_lane(const glm::vec3& barycentrics, int lane, ShadowPoint& out) {
    for (int k = 0; k < 3; ++k) out.barycentrics[k][lane] = barycentrics[k];
}

// Barycentrics of a few samples, evenly chosen from any number of them.
class FewPoints {
  public:
    // Every stride-th is kept, a power of two; when there are too many, every other one is dropped.
    void add(const glm::vec3& b) {
        if ((seen_++ & (stride_ - 1)) != 0) return;
        if (count_ == kLookups) {
            for (int i = 1; i < kLookups / 2; ++i) points_[i] = points_[2 * i];
            count_ = kLookups / 2;
            stride_ *= 2;
        }
        points_[count_++] = b;
    }
    void write(int quarter, ShadowPoint& out) const {
        for (int i = 0; i < kLookups && count_ > 0; ++i) write_lane(points_[i % count_], kLookups * quarter + i, out);
    }

  private:
    glm::vec3 points_[kLookups];
    int count_ = 0, seen_ = 0, stride_ = 1;
};

// What the samples of a pixel that see one side of a triangle have in common.
struct PointSamples {
    glm::vec3 sum{0.0f};
    int count = 0;
    FewPoints quarter[kQuarters];
    QuarterColors colors;
};

// Of a pixel in the picture, for what has to be random in it.
std::uint32_t seed_of(const Tile& tile, std::uint32_t pixel, std::uint32_t salt) {
    const int block = static_cast<int>(pixel) / kLanes, lane = static_cast<int>(pixel) % kLanes;
    const int x = tile.cell_x() * kCellSize + block % kCellBlocks * kBlockSize + lane % kBlockSize;
    const int y = tile.cell_y() * kCellSize + block / kCellBlocks * kBlockSize + lane / kBlockSize;
    return mix(mix(static_cast<std::uint32_t>(x) + 0x9e3779b9u * salt) + static_cast<std::uint32_t>(y));
}

}  // namespace

void TileShader::start(const SampleTable& samples, const Hits& hits) {
    per_block_ = static_cast<std::uint32_t>(samples.slots()) * kLanes;
    reciprocal_ = ((std::uint64_t{1} << kReciprocalBits) + per_block_ - 1) / per_block_;
    for (std::uint32_t block = 0; block < kBlocksPerCell; ++block)
        skipped_[block] = block * per_block_ - hits.first(static_cast<int>(block));
}

std::int64_t TileShader::shade(const ShadingScene& scene, const SampleTable& samples, const Tile& tile,
                               const Hits& hits, TileShade& out, bool roughly) {
    scene_ = &scene;
    const ShadowCellStore::Visit visit(scene.shadows().store());
    by_quarters_ = scene.shadows().move();
    start(samples, hits);
    shaded_ = 0;
    waiting_.start(scene);
    out.point_of_sample.assign(hits.triangle.size(), kBackground);
    out.colors.clear();
    const SampleVector* vectors = samples.cell(tile.cell_x(), tile.cell_y(), room_).data();
    seen_.start(scene.frame(), cell_centre(scene.frame().view, tile.cell_x(), tile.cell_y()),
                roughly ? kRoughLevel : 0);

    const auto indices = samples.indices_of_cell(tile.cell_x(), tile.cell_y());
    const bool sorted = TileSamples::is_by_pixel(samples);
    const float blur_share = scene.blur_share(samples.spp());
    // Of what does not blur, pixels are the cells; there the mean of the samples is better than the middle.
    const bool in_cells = scene.options().rate == ShadingRate::kDecoupled;
    const int blocks_per_chunk = std::max(1, kSamplesPerChunk / (kLanes * samples.slots()));
    for (int block = 0; block < kBlocksPerCell; block += blocks_per_chunk) {
        samples_.collect(samples, vectors, tile, hits, block, std::min(block + blocks_per_chunk, kBlocksPerCell));
        if (scene.has_background()) shade_background(vectors, tile, out);
        for (std::size_t i = 0; i < samples_.triangle_count(); ++i) {
            const std::uint32_t triangle = samples_.triangle(i);
            const ShadedTriangle shaded(scene, triangle, blur_share);
            const bool cells = in_cells && (roughly || !shaded.is_sharp());
            const SampleRun seen = samples_.samples(i);
            const Run run{shaded, triangle, cells || sorted ? seen : by_pixel(seen, indices)};
            seen_.see(triangle, run.samples, cells ? &shaded.cells() : nullptr);
            if (cells) {
                find_cells(run, out);
                shade_cells(run, out);
            } else {
                shade_pixels(run, tile, out);
            }
        }
    }
    waiting_.finish(out);
    return shaded_;
}

void TileShader::shade_misses(const ShadingScene& scene, const SampleTable& samples, const Tile& tile, const Hits& hits,
                              TileShade& out) {
    if (!scene.has_background()) return;
    scene_ = &scene;
    start(samples, hits);
    const SampleVector* vectors = samples.cell(tile.cell_x(), tile.cell_y(), room_).data();
    const int blocks_per_chunk = std::max(1, kSamplesPerChunk / (kLanes * samples.slots()));
    for (int block = 0; block < kBlocksPerCell; block += blocks_per_chunk) {
        samples_.collect(samples, vectors, tile, hits, block, std::min(block + blocks_per_chunk, kBlocksPerCell));
        shade_background(vectors, tile, out);
    }
}

WaitingPoint& TileShader::add_point(const Run& run, const glm::vec3& barycentrics, bool front, const ShadingCell& cell,
                                    TileShade& out) {
    ++shaded_;
    WaitingPoint& point = waiting_.add(run.triangle.material(), run.triangle.surface(barycentrics, front, cell), out);
    point.triangle = run.number;
    return point;
}

// The samples pixel by pixel in index order, which says what is looked up of shadows: the same on any backend.
SampleRun TileShader::by_pixel(const SampleRun& samples, std::span<const std::uint16_t> indices) {
    const std::span<const std::uint32_t> places = samples.places;
    Reordered& out = by_pixel_;
    out.order.resize(places.size());
    for (std::size_t begin = 0; begin < places.size();) {
        const std::uint32_t block_end = (block_of(places[begin]) + 1) * per_block_;
        std::size_t ends[kLanes + 1] = {}, end = begin;  // of each pixel's samples; at first their number
        for (; end < places.size() && places[end] < block_end; ++end) ++ends[places[end] % kLanes + 1];
        std::partial_sum(std::begin(ends), std::end(ends), std::begin(ends));
        const auto first = out.order.begin() + static_cast<std::ptrdiff_t>(begin);
        for (std::size_t i = begin; i < end; ++i)
            first[static_cast<std::ptrdiff_t>(ends[places[i] % kLanes]++)] = static_cast<std::uint32_t>(i);
        const auto by_index = [&](std::uint32_t a, std::uint32_t b) { return indices[places[a]] < indices[places[b]]; };
        for (int lane = 0; lane < kLanes; ++lane) {
            const auto from = first + static_cast<std::ptrdiff_t>(lane == 0 ? 0 : ends[lane - 1]);
            const auto to = first + static_cast<std::ptrdiff_t>(ends[lane]);
            if (!std::is_sorted(from, to, by_index)) std::sort(from, to, by_index);
        }
        begin = end;
    }
    out.places.resize(places.size() + kLanes);
    out.xyuv.resize(places.size() + kLanes);
    out.t.resize(places.size() + kLanes);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const std::uint32_t from = out.order[i];
        out.places[i] = places[from];
        out.xyuv[i] = samples.xyuv[from];
        out.t[i] = samples.t[from];
    }
    return {std::span(out.places).first(places.size()), out.xyuv.data(), out.t.data()};
}

// The samples of one pixel share a point, or none do; those that see the back are another point.
void TileShader::shade_pixels(const Run& run, const Tile& tile, TileShade& out) {
    const bool each = scene_->options().rate == ShadingRate::kSample;
    for (std::size_t begin = 0; begin < run.samples.places.size();) {
        const std::uint32_t block = block_of(run.samples.places[begin]), lane = run.samples.places[begin] % kLanes;
        const auto is_here = [&](std::uint32_t place) {
            return place - block * per_block_ < per_block_ && place % kLanes == lane;
        };
        PointSamples points[2];
        const std::size_t last = each ? begin + 1 : run.samples.places.size();
        for (; begin < last && is_here(run.samples.places[begin]); ++begin) {
            const glm::vec3 b = seen_.barycentrics(begin);
            PointSamples& point = points[seen_.key(begin).front()];
            point.sum += b;
            ++point.count;
            const int quarter = quarter_of(run.samples.t[begin]);
            point.quarter[quarter].add(b);
            out.point_of_sample[entry(run.samples.places[begin])] = point.colors.at(quarter, out);
        }
        for (int front = 0; front < 2; ++front) {
            const PointSamples& point = points[front];
            if (point.count == 0) continue;
            const glm::vec3 b = point.sum / static_cast<float>(point.count);
            WaitingPoint& waiting = add_point(run, b, front != 0, ShadingCell{}, out);
            waiting.seed = seed_of(tile, block * kLanes + lane, static_cast<std::uint32_t>(front));
            waiting.colors = point.colors;
            for (int q = 0; q < kQuarters; ++q) point.quarter[by_quarters_ ? q : 0].write(q, waiting.shadow);
        }
    }
}

// Numbers the cells as their samples come, and gives each sample the place of its colour.
void TileShader::find_cells(const Run& run, TileShade& out) {
    cells_.clear();
    std::size_t size = 16;
    while (size < 2 * run.samples.places.size()) size *= 2;
    cell_table_.assign(size, 0u);
    for (std::size_t i = 0; i < run.samples.places.size(); ++i) {
        const CellKey key = seen_.key(i);
        const std::uint64_t whole = std::uint64_t{key.kind} << 32 | key.place;
        std::size_t at = static_cast<std::size_t>(whole * 0x9e3779b97f4a7c15ull >> 40) & (size - 1);
        while (cell_table_[at] != 0 && !(cells_[cell_table_[at] - 1].key == key)) at = (at + 1) & (size - 1);
        if (cell_table_[at] == 0) {
            cells_.push_back({key, i, {}});
            cell_table_[at] = static_cast<std::uint32_t>(cells_.size());
        }
        out.point_of_sample[entry(run.samples.places[i])] =
            cells_[cell_table_[at] - 1].colors.at(quarter_of(run.samples.t[i]), out);
    }
}

// Everything of a cell follows from the cell alone, so nothing depends on which tiles see parts of it.
void TileShader::shade_cells(const Run& run, TileShade& out) {
    for (const SharedCell& shared : cells_) {
        const bool alone = shared.key.alone();
        const ShadingCell cell = alone ? ShadingCell{} : shared.key.cell();
        const glm::vec3 b = alone ? seen_.barycentrics(shared.first) : run.triangle.barycentrics_at(cell.centre);
        WaitingPoint& waiting = add_point(run, b, shared.key.front(), cell, out);
        waiting.seed = mix(shared.key.place + mix(shared.key.kind + run.number));
        waiting.colors = shared.colors;
        if (!scene_->shadows().any()) continue;
        glm::vec3 parts[kLookups] = {b, b, b, b};
        if (!alone) run.triangle.barycentrics_of_quarters(cell, parts);
        for (int lane = 0; lane < ShadowPoint::kLanes; ++lane) write_lane(parts[lane % kLookups], lane, waiting.shadow);
    }
}

// The mean of what a pixel's misses see of the surroundings, each along its own ray.
void TileShader::shade_background(const SampleVector* samples, const Tile& tile, TileShade& out) {
    const CellCentre centre = cell_centre(scene_->frame().view, tile.cell_x(), tile.cell_y());
    const std::span<const std::uint32_t> misses = samples_.misses();
    for (std::size_t i = 0; i < misses.size();) {
        const std::uint32_t end = (block_of(misses[i]) + 1) * per_block_;
        glm::vec4 sums[kLanes] = {};  // and how many
        std::uint32_t points[kLanes];
        for (; i < misses.size() && misses[i] < end; ++i) {
            const std::uint32_t place = misses[i], lane = place % kLanes;
            if (sums[lane].w == 0.0f) {
                points[lane] = static_cast<std::uint32_t>(out.colors.size());
                out.colors.emplace_back();
            }
            const SampleVector& s = samples[place / kLanes];
            sums[lane] += glm::vec4(
                scene_->background(centre.x + s.x[lane], centre.y + s.y[lane], s.u[lane], s.v[lane], s.t[lane]), 1.0f);
            out.point_of_sample[entry(place)] = points[lane];
        }
        for (int lane = 0; lane < kLanes; ++lane) {
            if (sums[lane].w == 0.0f) continue;
            glm::vec4& color = out.colors[points[lane]];
            color = contained(glm::vec3(sums[lane]) / sums[lane].w);
            color.w = 0.0f;
        }
    }
}

}  // namespace pentaprism
