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
constexpr int kQuarters = ShadowMap::kSamples;
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
    std::uint32_t color[kQuarters] = {kBackground, kBackground, kBackground, kBackground};

    ShadowReceiver receiver(int q) const {
        ShadowReceiver out;
        out.quarter = q;
        quarter[q].write(out);
        return out;
    }
};

// Of a pixel in the picture, for what has to be random in it.
std::uint32_t seed_of(const Tile& tile, int pixel, std::uint32_t salt) {
    const int block = pixel / kLanes, lane = pixel % kLanes;
    const int x = tile.cell_x() * kCellSize + block % kCellBlocks * kBlockSize + lane % kBlockSize;
    const int y = tile.cell_y() * kCellSize + block / kCellBlocks * kBlockSize + lane / kBlockSize;
    return mix(mix(static_cast<std::uint32_t>(x) + 0x9e3779b9u * salt) + static_cast<std::uint32_t>(y));
}

// One triangle in its cell, localized for each segment of its motion when a sample first asks.
class LocalRun {
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
        return project(lanes_[segment], sample);
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
class CellSamples {
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

std::size_t hit_index(int pixel, int slot, int slots) {
    return (static_cast<std::size_t>(pixel / kLanes) * slots + slot) * kLanes + pixel % kLanes;
}

}  // namespace

std::int64_t TileShader::shade(const ShadingScene& scene, const SampleTable& samples, const Tile& tile,
                               const Hits& hits, TileShade& out) {
    const Frame& frame = scene.frame();
    const Shadows& shadows = scene.shadows();
    std::int64_t shaded_points = 0;
    PointSamples points[2];
    const int slots = samples.slots();
    out.point_of_sample.resize(hits.triangle.size());
    out.colors.clear();

    const CellSamples cell(samples, tile);
    LocalRun run(frame, cell_centre(frame.view, tile.cell_x(), tile.cell_y()));
    const int blocks_per_chunk = std::max(1, kSamplesPerChunk / (kLanes * slots));
    for (int block = 0; block < kBlocksPerCell; block += blocks_per_chunk) {
        collect(samples, tile, hits, block, std::min(block + blocks_per_chunk, kBlocksPerCell), out);
        sort_by_triangle();
        std::uint32_t begin = 0;
        for (std::size_t number = 0; number < triangles_.size(); ++number) {
            const std::uint32_t end = counts_[number];
            run.start(triangles_[number]);
            const ShadedTriangle shaded(scene, triangles_[number]);
            while (begin < end) {
                // The samples of one pixel, in index order; those that see the back are another point. Where shadows
                // fall, a point has a colour for each quarter of the shutter.
                const std::uint16_t pixel = sorted_[begin].pixel;
                for (PointSamples& point : points) point = {};
                for (; begin < end && sorted_[begin].pixel == pixel; ++begin) {
                    const int slot = sorted_[begin].slot;
                    const LocalSample sample = cell.at(pixel, slot);
                    const Seen seen = run.see(sample);
                    PointSamples& point = points[seen.front];
                    point.all.add(seen.barycentrics);
                    const int quarter =
                        shadows.any() ? std::min(static_cast<int>(sample.t * kQuarters), kQuarters - 1) : 0;
                    point.quarter[quarter].add(seen.barycentrics);
                    if (point.color[quarter] == kBackground) {
                        point.color[quarter] = static_cast<std::uint32_t>(out.colors.size());
                        out.colors.emplace_back();
                    }
                    out.point_of_sample[hit_index(pixel, slot, slots)] = point.color[quarter];
                }
                for (int front = 0; front < 2; ++front) {
                    const PointSamples& point = points[front];
                    if (point.all.count() == 0) continue;
                    ++shaded_points;
                    shaded.shade(point.all.value(), front != 0, lit_);
                    const float texel = lit_.shadowed.empty() ? 0.0f : scene.shadow_texel(lit_.position);
                    for (int q = 0; q < kQuarters; ++q) {
                        if (point.color[q] == kBackground) continue;
                        glm::vec3 color = lit_.rest;
                        ShadowReceiver receiver = point.receiver(q);
                        receiver.triangle = triangles_[number];
                        receiver.texel = texel;
                        for (const LitColor::Share& share : lit_.shadowed) {
                            receiver.offset = share.offset;
                            color += share.color * shadows.lit(share.light, receiver, lit_.position,
                                                               seed_of(tile, pixel, 8 * share.light + 2 * q + front));
                        }
                        out.colors[point.color[q]] = contained(color);
                    }
                }
            }
        }
    }
    return shaded_points;
}

// Lists the covered samples of some blocks pixel by pixel in index order, and numbers the triangles as they come.
void TileShader::collect(const SampleTable& samples, const Tile& tile, const Hits& hits, int first_block,
                         int last_block, TileShade& out) {
    entries_.clear();
    locals_.clear();
    counts_.clear();
    triangles_.clear();
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
