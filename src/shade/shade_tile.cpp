#include "shade/shade_tile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "bound/local_triangle.h"
#include "sample/net.h"
#include "shade/projection.h"
#include "shade/sample_order.h"
#include "shade/shaded_triangle.h"

namespace pentaprism {
namespace {

// A point belongs to one pixel, so a tile may be shaded in pieces of whole blocks: memory stays bounded at 4096 samples
// a pixel.
constexpr int kSamplesPerChunk = 1 << 16;
constexpr int kQuarters = QuarterColors::kQuarters;
constexpr float kBrightest = 0x1p20f;

glm::vec4 contained(const glm::vec3& color) {
    const auto one = [](float x) { return std::isfinite(x) ? std::clamp(x, 0.0f, kBrightest) : 0.0f; };
    return {one(color.x), one(color.y), one(color.z), 1.0f};
}

// The mean of barycentrics, inside the triangle: rounding, and slivers' samples, may lie just outside.
class Mean {
  public:
    void add(Float4 b) {
        ++count_;
        if (!std::isfinite(b[0] + b[1] + b[2])) return;
        sum_ += b;
        ++finite_;
    }
    int count() const { return count_; }
    glm::vec3 value() const {
        const glm::vec3 inside(std::max(sum_[0], 0.0f), std::max(sum_[1], 0.0f), std::max(sum_[2], 0.0f));
        const float total = inside.x + inside.y + inside.z;
        return finite_ > 0 && total > 0.0f ? inside / total : glm::vec3(1.0f / 3.0f);
    }

  private:
    Float4 sum_ = splat(0.0f);
    int count_ = 0, finite_ = 0;
};

// Barycentrics of a few samples, evenly chosen from any number of them; each inside the triangle.
class FewPoints {
  public:
    // Every `stride`-th is kept; when there are too many, every other one is dropped.
    void add(Float4 b) {
        if (seen_++ % stride_ != 0) return;
        if (count_ == ShadowReceiver::kPoints) {
            for (int i = 1; i < ShadowReceiver::kPoints / 2; ++i) points_[i] = points_[2 * i];
            count_ = ShadowReceiver::kPoints / 2;
            stride_ *= 2;
        }
        points_[count_++] = b;
    }
    void write(ShadowReceiver& out) const {
        out.count = count_;
        for (int i = 0; i < count_; ++i) {
            Mean one;
            one.add(points_[i]);
            out.points[i] = one.value();
        }
    }

  private:
    Float4 points_[ShadowReceiver::kPoints];
    int count_ = 0, seen_ = 0, stride_ = 1;
};

// What the samples of a pixel that see one side of a triangle have in common.
struct PointSamples {
    Mean all;
    FewPoints quarter[kQuarters];
    QuarterColors colors;
};

int quarter_of(float t) {
    return std::min(static_cast<int>(t * kQuarters), kQuarters - 1);
}

// Of a pixel in the picture, for what has to be random in it.
std::uint32_t seed_of(const Tile& tile, int pixel, std::uint32_t salt) {
    const int block = pixel / kLanes, lane = pixel % kLanes;
    const int x = tile.cell_x() * kCellSize + block % kCellBlocks * kBlockSize + lane % kBlockSize;
    const int y = tile.cell_y() * kCellSize + block / kCellBlocks * kBlockSize + lane / kBlockSize;
    return mix(mix(static_cast<std::uint32_t>(x) + 0x9e3779b9u * salt) + static_cast<std::uint32_t>(y));
}

}  // namespace

// One triangle in its cell, localized for each segment of its motion when a sample first asks. Shading knows whole
// triangles alone, so what a sample sees of a piece is told in terms of these.
class TileShader::LocalRun {
  public:
    LocalRun(const Frame& frame, const CellCentre& centre) : frame_(frame), centre_(centre) {}

    void start(std::uint32_t triangle) {
        triangle_ = triangle;
        segments_ = frame_.parts[frame_.part_of[triangle]].segments;
        ready_.assign(segments_, 0);
        if (static_cast<int>(lanes_.size()) < segments_) lanes_.resize(segments_);
    }
    Seen see(const LocalSample& sample) {
        const int segment = std::min(static_cast<int>(sample.t * static_cast<float>(segments_)), segments_ - 1);
        if (!ready_[segment]) {
            lanes_[segment] = CornerLanes(localize(frame_, triangle_, segment, centre_));
            ready_[segment] = 1;
        }
        Seen seen = project(lanes_[segment], sample);
        if (frame_.pieces.empty()) return seen;
        const Float4 b = seen.barycentrics;
        const glm::vec3 in_source = frame_.in_source(triangle_, {b[0], b[1], b[2]});
        seen.barycentrics = Float4{in_source.x, in_source.y, in_source.z, 0.0f};
        return seen;
    }

  private:
    const Frame& frame_;
    CellCentre centre_;
    std::uint32_t triangle_ = 0;
    int segments_ = 1;
    std::vector<std::uint8_t> ready_;
    std::vector<CornerLanes> lanes_;
};

// The table's samples of a cell, as the exact test sees them.
class TileShader::CellSamples {
  public:
    CellSamples(const SampleTable& samples, const Tile& tile) {
        vectors_ = samples.cell(tile.cell_x(), tile.cell_y(), room_);
        slots_ = static_cast<std::size_t>(samples.slots());
    }
    LocalSample at(int pixel, int slot) const {
        const int block = pixel / kLanes, lane = pixel % kLanes;
        const SampleVector& vector = vectors_[block * slots_ + slot];
        return {vector.x[lane], vector.y[lane], vector.u[lane], vector.v[lane], vector.t[lane]};
    }

  private:
    std::vector<SampleVector> room_;
    std::span<const SampleVector> vectors_;
    std::size_t slots_;
};

namespace {

std::size_t hit_index(int pixel, int slot, int slots) {
    return (static_cast<std::size_t>(pixel / kLanes) * slots + slot) * kLanes + pixel % kLanes;
}

}  // namespace

std::int64_t TileShader::shade(const ShadingScene& scene, const SampleTable& samples, const Tile& tile,
                               const Hits& hits, TileShade& out) {
    const Frame& frame = scene.frame();
    const bool shadows = scene.shadows().any();
    shaded_ = 0;
    PointSamples points[2];
    const int slots = samples.slots();
    out.point_of_sample.resize(hits.triangle.size());
    out.colors.clear();

    const CellSamples cell(samples, tile);
    LocalRun run(frame, cell_centre(frame.view, tile.cell_x(), tile.cell_y()));
    const int blocks_per_chunk = std::max(1, kSamplesPerChunk / (kLanes * slots));
    for (int block = 0; block < kBlocksPerCell; block += blocks_per_chunk) {
        collect(scene, samples, tile, hits, block, std::min(block + blocks_per_chunk, kBlocksPerCell), out);
        shade_background(scene, samples, tile, out);
        sort_by_triangle();
        std::uint32_t begin = 0;
        for (std::size_t number = 0; number < triangles_.size(); ++number) {
            const std::uint32_t end = counts_[number];
            run.start(triangles_[number]);
            const ShadedTriangle shaded(scene, triangles_[number]);
            locals_of_run_ = number;
            if (scene.options().rate == ShadingRate::kDecoupled) {
                shade_cells(scene, cell, shaded, run, begin, end, slots, out);
                begin = end;
                continue;
            }
            while (begin < end) {
                // The samples of one pixel, in index order; those that see the back are another point. Where shadows
                // fall, a point has a colour for each quarter of the shutter.
                const std::uint16_t pixel = sorted_[begin].pixel;
                for (PointSamples& point : points) point = {};
                const std::uint32_t last = scene.options().rate == ShadingRate::kSample ? begin + 1 : end;
                for (; begin < last && sorted_[begin].pixel == pixel; ++begin) {
                    const int slot = sorted_[begin].slot;
                    const LocalSample sample = cell.at(pixel, slot);
                    const Seen seen = run.see(sample);
                    PointSamples& point = points[seen.front];
                    point.all.add(seen.barycentrics);
                    const int quarter = shadows ? quarter_of(sample.t) : 0;
                    point.quarter[quarter].add(seen.barycentrics);
                    out.point_of_sample[hit_index(pixel, slot, slots)] = point.colors.at(quarter, out);
                }
                for (int front = 0; front < 2; ++front) {
                    const PointSamples& point = points[front];
                    if (point.all.count() == 0) continue;
                    ++shaded_;
                    shaded.shade(point.all.value(), front != 0, ShadingCell{}, lit_);
                    light_quarters(
                        scene, point.colors, triangles_[number], seed_of(tile, pixel, front),
                        [&](int q, ShadowReceiver& receiver) { point.quarter[q].write(receiver); }, out);
                }
            }
        }
    }
    return shaded_;
}

// What shadows leave of a point's light in each quarter of the shutter that its samples see.
template <class Points>
void TileShader::light_quarters(const ShadingScene& scene, const QuarterColors& colors, std::uint32_t triangle,
                                std::uint32_t seed, const Points& write_points, TileShade& out) {
    ShadowReceiver receiver;
    receiver.triangle = triangle;
    if (!lit_.shadowed.empty()) receiver.texel = scene.shadow_texel(lit_.position);
    for (int q = 0; q < kQuarters; ++q) {
        if (colors.color[q] == kBackground) continue;
        glm::vec3 color = lit_.rest;
        if (!lit_.shadowed.empty()) {
            receiver.quarter = q;
            write_points(q, receiver);
            for (const LitColor::Share& share : lit_.shadowed) {
                receiver.offset = share.offset;
                color += share.color *
                         scene.shadows().lit(share.light, receiver, lit_.position, mix(seed + 8 * share.light + 2 * q));
            }
        }
        out.colors[colors.color[q]] = contained(color);
    }
}

// Everything of a cell follows from the cell alone, so nothing depends on which tiles see parts of it.
void TileShader::shade_cells(const ShadingScene& scene, const CellSamples& samples, const ShadedTriangle& shaded,
                             LocalRun& run, std::uint32_t begin, std::uint32_t end, int slots, TileShade& out) {
    const bool shadows = scene.shadows().any();
    const std::uint32_t triangle = triangles_[locals_of_run_];
    cells_.clear();
    std::size_t size = 16;
    while (size < 2 * static_cast<std::size_t>(end - begin)) size *= 2;
    cell_table_.assign(size, 0u);
    for (; begin < end; ++begin) {
        const std::uint16_t pixel = sorted_[begin].pixel;
        const int slot = sorted_[begin].slot;
        const LocalSample sample = samples.at(pixel, slot);
        const Seen seen = run.see(sample);
        Mean own;
        own.add(seen.barycentrics);
        const glm::vec3 b = own.value();
        ShadingCell cell = shaded.cell_of(b);
        const bool alone = cell.key == 0;
        if (alone) cell.key = (std::uint64_t{1} << 63) | (std::uint64_t{pixel} << 16) | static_cast<unsigned>(slot);
        cell.key = 2 * cell.key + (seen.front ? 1 : 0);
        std::size_t at = static_cast<std::size_t>(cell.key * 0x9e3779b97f4a7c15ull >> 40) & (size - 1);
        while (cell_table_[at] != 0 && cells_[cell_table_[at] - 1].cell.key != cell.key) at = (at + 1) & (size - 1);
        if (cell_table_[at] == 0) {
            cells_.push_back({cell, alone, seen.front, b, {}});
            cell_table_[at] = static_cast<std::uint32_t>(cells_.size());
        }
        QuarterColors& colors = cells_[cell_table_[at] - 1].colors;
        out.point_of_sample[hit_index(pixel, slot, slots)] = colors.at(shadows ? quarter_of(sample.t) : 0, out);
    }
    for (const SharedCell& shared : cells_) {
        ++shaded_;
        const ShadingCell& cell = shared.cell;
        const glm::vec3 b = shared.alone ? shared.barycentrics : shaded.barycentrics_at(cell.centre);
        shaded.shade(b, shared.front, cell, lit_);
        const std::uint32_t seed =
            mix(static_cast<std::uint32_t>(cell.key) + mix(static_cast<std::uint32_t>(cell.key >> 32) + triangle));
        light_quarters(
            scene, shared.colors, triangle, seed,
            [&](int, ShadowReceiver& receiver) {
                receiver.count = shared.alone ? 1 : 4;
                receiver.points[0] = b;
                for (int i = 0; i < 4 && !shared.alone; ++i)
                    receiver.points[i] =
                        shaded.barycentrics_at(cell.centre + (i % 2 ? 0.25 : -0.25) * glm::dvec2(cell.along) +
                                               (i / 2 ? 0.25 : -0.25) * glm::dvec2(cell.across));
            },
            out);
    }
}

// Lists the covered samples of some blocks pixel by pixel in index order, and numbers the triangles as they come.
void TileShader::collect(const ShadingScene& scene, const SampleTable& samples, const Tile& tile, const Hits& hits,
                         int first_block, int last_block, TileShade& out) {
    entries_.clear();
    locals_.clear();
    counts_.clear();
    triangles_.clear();
    misses_.clear();
    std::fill(table_.begin(), table_.end(), 0u);
    const int slots = samples.slots();
    static thread_local SampleOrder order;
    for (int block = first_block; block < last_block; ++block) {
        const int bx = tile.cell_x() * kCellBlocks + block % kCellBlocks;
        const int by = tile.cell_y() * kCellBlocks + block / kCellBlocks;
        if (bx * kBlockSize < tile.x0 || bx * kBlockSize >= tile.x1) continue;
        if (by * kBlockSize < tile.y0 || by * kBlockSize >= tile.y1) continue;
        order.read(samples, bx, by);
        for (int lane = 0; lane < kLanes; ++lane) {
            const std::uint16_t* slot = order.slots(lane);
            const int pixel = block * kLanes + lane;
            for (int index = 0; index < slots; ++index) {
                const std::size_t at = hit_index(pixel, slot[index], slots);
                const std::uint32_t triangle = hits.triangle[at];
                if (triangle == kNoTriangle) {
                    out.point_of_sample[at] = kBackground;
                    if (scene.has_background()) misses_.push_back({static_cast<std::uint16_t>(pixel), slot[index]});
                    continue;
                }
                const std::uint32_t local = !locals_.empty() && triangles_[locals_.back()] == triangle
                                                ? locals_.back()
                                                : local_triangle(triangle);
                ++counts_[local];
                locals_.push_back(local);
                entries_.push_back({static_cast<std::uint16_t>(pixel), slot[index]});
            }
        }
    }
}

// The mean of what a pixel's misses see of the surroundings, each along its own ray.
void TileShader::shade_background(const ShadingScene& scene, const SampleTable& samples, const Tile& tile,
                                  TileShade& out) {
    const CellSamples cell(samples, tile);
    const CellCentre centre = cell_centre(scene.frame().view, tile.cell_x(), tile.cell_y());
    for (std::size_t begin = 0; begin < misses_.size();) {
        const std::uint16_t pixel = misses_[begin].pixel;
        glm::vec3 sum(0.0f);
        float count = 0.0f;
        for (; begin < misses_.size() && misses_[begin].pixel == pixel; ++begin) {
            const LocalSample s = cell.at(pixel, misses_[begin].slot);
            sum += scene.background(centre.x + s.hx, centre.y + s.hy, s.u, s.v, s.t);
            count += 1.0f;
            out.point_of_sample[hit_index(pixel, misses_[begin].slot, samples.slots())] =
                static_cast<std::uint32_t>(out.colors.size());
        }
        out.colors.push_back(contained(sum / count));
        out.colors.back().w = 0.0f;
    }
}

// Stable, so pixels and indices stay in order within a triangle.
void TileShader::sort_by_triangle() {
    sorted_.resize(entries_.size());
    std::uint32_t sum = 0;
    for (std::uint32_t& count : counts_) {
        const std::uint32_t here = count;
        count = sum;
        sum += here;
    }
    for (std::size_t i = 0; i < entries_.size(); ++i) sorted_[counts_[locals_[i]]++] = entries_[i];
}

std::uint32_t TileShader::local_triangle(std::uint32_t triangle) {
    if (2 * (triangles_.size() + 1) > table_.size()) grow_table();
    const std::size_t mask = table_.size() - 1;
    std::size_t at = (triangle * 0x9e3779b1u >> 7) & mask;
    while (table_[at] != 0) {
        if (triangles_[table_[at] - 1] == triangle) return table_[at] - 1;
        at = (at + 1) & mask;
    }
    triangles_.push_back(triangle);
    counts_.push_back(0);
    table_[at] = static_cast<std::uint32_t>(triangles_.size());
    return table_[at] - 1;
}

// At most half full, so that a search always ends at an empty entry.
void TileShader::grow_table() {
    table_.assign(std::max<std::size_t>(1024, 2 * table_.size()), 0u);
    const std::size_t mask = table_.size() - 1;
    for (std::size_t number = 0; number < triangles_.size(); ++number) {
        std::size_t at = (triangles_[number] * 0x9e3779b1u >> 7) & mask;
        while (table_[at] != 0) at = (at + 1) & mask;
        table_[at] = static_cast<std::uint32_t>(number + 1);
    }
}

}  // namespace pentaprism
