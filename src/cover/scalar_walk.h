#pragma once
// The readable way over a tile: one triangle after the other, one sample at a time, with any culling tests.
// cover_with_test.cpp and cover_layers.cpp say what is done with what is hit.

#include <algorithm>
#include <bit>
#include <cmath>

#include "cover/cover.h"
#include "cover/exact.h"
#include "cover/front_to_back.h"

namespace pentaprism {

/// A sample of the tile.
struct SamplePlace {
    std::size_t index;  ///< in Hits
    int px, py;         ///< of the picture
    int slot, lane;     ///< SampleTable::indices(px / kBlockSize, py / kBlockSize)[slot * kLanes + lane]
};

namespace scalar_walk {

inline constexpr int kGrainCount = 3;
inline constexpr float kHalfCell = kCellSize / 2;

// Pixels [x0, x1) x [y0, y1), counted from the cell's top left corner.
struct Rect {
    int x0, x1, y0, y1;
    bool empty() const { return x0 >= x1 || y0 >= y1; }
};

// Exactly the closed square that holds the samples of pixels (x, y) to (x + size - 1, y + size - 1) of the cell.
inline Footprint square(int x, int y, int size, const Domain& domain) {
    const float left = static_cast<float>(x) - kHalfCell, top = kHalfCell - static_cast<float>(y);
    const float side = static_cast<float>(size);
    return {left, left + side, top - side, top, domain};
}

// The smallest footprint that holds the samples of a vector.
inline Footprint bucket(const SampleVector& s) {
    const auto [x0, x1] = std::minmax_element(s.x, s.x + kLanes);
    const auto [y0, y1] = std::minmax_element(s.y, s.y + kLanes);
    const auto [u0, u1] = std::minmax_element(s.u, s.u + kLanes);
    const auto [v0, v1] = std::minmax_element(s.v, s.v + kLanes);
    const auto [t0, t1] = std::minmax_element(s.t, s.t + kLanes);
    return {*x0, *x1, *y0, *y1, {*u0, *u1, *v0, *v1, *t0, *t1}};
}

// A step of the culling and what it knows of the triangle at hand: a state for the tile, one for each pixel of the
// block, or one for the bucket.
struct Step {
    const CullTest* test;
    CullSetup setup;
    CullState states[kLanes];
};

}  // namespace scalar_walk

/// Takes the tile's triangles through tiles of 8x8 pixels, blocks of 4x4, and the vectors of a block.
/// `found(triangle, hit, place)` is called for each sample that the exact test accepts, before depth and opacity, and
/// says whether `shown`, of which occluders are made, is now another for that sample.
template <class Found>
class ScalarWalk {
  public:
    ScalarWalk(const TileWork& work, const Culling& culling, const Hits& shown, CoverCounts& counts, Found& found)
        : work_(work),
          shown_(shown),
          counts_(counts),
          found_(found),
          centre_(cell_centre(work.frame.view, work.tile.cell_x(), work.tile.cell_y())),
          left_(work.tile.cell_x() * kCellSize),
          top_(work.tile.cell_y() * kCellSize),
          slots_(work.samples.slots()),
          vectors_(work.samples.cell(work.tile.cell_x(), work.tile.cell_y(), room_)) {
        const View& view = work.frame.view;
        const float ratio = static_cast<float>(view.lens.ratio);
        whole_ = {-1.0f, 1.0f, -ratio, ratio, 0.0f, 1.0f};
        const float x = -0.5f * static_cast<float>(view.width) - centre_.x,
                    y = -0.5f * static_cast<float>(view.height) - centre_.y;
        picture_ = {x, x + static_cast<float>(view.width), y, y + static_cast<float>(view.height), whole_};
        for (const CullStep& step : culling) ++step_count_[static_cast<int>(step.grain)];
        for (int grain = 0, first = 0; grain < scalar_walk::kGrainCount; first += step_count_[grain++])
            first_step_[grain] = first;
        steps_.resize(culling.size());
        for (std::size_t i = 0; i < culling.size(); ++i) {
            steps_[i].test = culling[i].test;
            for (CullState& state : steps_[i].states) state.setup = &steps_[i].setup;
            if (!culling[i].test->asks_occluders) continue;
            steps_[i].setup.occluders = &occluders_;
            asks_occluders_ = true;
        }
        if (!steps(Grain::kBucket).empty()) {
            buckets_.reserve(vectors_.size());
            for (const SampleVector& vector : vectors_) buckets_.push_back(scalar_walk::bucket(vector));
        }
    }

    void cover_all() {
        if (!asks_occluders_) {
            for (const std::uint32_t entry : work_.list) cover(work_.triangles[entry]);
            return;
        }
        constexpr std::size_t kBetweenUpdates = 32;
        const std::vector<std::uint32_t> order = front_to_back(work_);
        for (std::size_t i = 0; i < order.size(); ++i) {
            if (std::has_single_bit(i) || i % kBetweenUpdates == 0) update_occluders();
            cover(work_.triangles[order[i]]);
        }
    }

  private:
    void cover(const BinnedTriangle& binned) {
        triangle_ = localize(work_.frame, binned.triangle, binned.segment, centre_, work_.scale);
        for (scalar_walk::Step& step : steps_)
            if (step.test->begin != nullptr && !step.test->begin(triangle_, picture_, step.setup)) return;
        const Tile& tile = work_.tile;
        pixels_ = {std::max<int>(binned.x0, tile.x0) - left_, std::min<int>(binned.x1, tile.x1) - left_,
                   std::max<int>(binned.y0, tile.y0) - top_, std::min<int>(binned.y1, tile.y1) - top_};
        if (pixels_.empty()) return;
        for_each_square(pixels_, kCullTileSize, [&](int x, int y) {
            if (!prepare(Grain::kTile, scalar_walk::square(x, y, kCullTileSize, whole_), 0)) return;
            for_each_square(cut(x, y, kCullTileSize), kBlockSize, [&](int bx, int by) { cover_block(bx, by); });
        });
    }

    std::span<scalar_walk::Step> steps(Grain grain) {
        const auto g = static_cast<std::size_t>(grain);
        return std::span(steps_).subspan(first_step_[g], step_count_[g]);
    }

    scalar_walk::Rect cut(int x, int y, int size) const {
        return {std::max(x, pixels_.x0), std::min(x + size, pixels_.x1), std::max(y, pixels_.y0),
                std::min(y + size, pixels_.y1)};
    }

    // The squares of a grid that the rectangle touches, by their corner.
    template <class Visit>
    static void for_each_square(const scalar_walk::Rect& rect, int size, Visit&& visit) {
        for (int y = rect.y0 / size * size; y < rect.y1; y += size)
            for (int x = rect.x0 / size * size; x < rect.x1; x += size) visit(x, y);
    }

    // False: a test of that grain refuses the footprint.
    bool prepare(Grain grain, const Footprint& footprint, int state) {
        for (scalar_walk::Step& step : steps(grain)) {
            ++counts_.footprints;
            if (!step.test->prepare(triangle_, footprint, step.states[state])) return false;
            ++counts_.kept_footprints;
        }
        return true;
    }

    bool keeps(Grain grain, const LocalSample& sample, int state) {
        for (const scalar_walk::Step& step : steps(grain)) {
            ++counts_.asked;
            if (!step.test->keeps(step.states[state], sample)) return false;
        }
        return true;
    }

    void cover_block(int x, int y) {
        if (!work_.tile.wants(x / kBlockSize, y / kBlockSize)) return;
        std::uint32_t lanes = 0;  // those whose pixel is kept
        const scalar_walk::Rect rect = cut(x, y, kBlockSize);
        for (int py = rect.y0; py < rect.y1; ++py)
            for (int px = rect.x0; px < rect.x1; ++px) {
                const int lane = (py - y) * kBlockSize + (px - x);
                if (prepare(Grain::kPixel, scalar_walk::square(px, py, 1, whole_), lane)) lanes |= 1u << lane;
            }
        if (lanes == 0) return;
        const int block = y / kBlockSize * kCellBlocks + x / kBlockSize;
        for (int slot = 0; slot < slots_; ++slot) {
            const std::size_t job = static_cast<std::size_t>(block) * slots_ + slot;
            if (!buckets_.empty() && !prepare(Grain::kBucket, buckets_[job], 0)) continue;
            for (std::uint32_t left = lanes; left != 0; left &= left - 1)
                cover_sample_of(x, y, slot, job, std::countr_zero(left));
        }
    }

    void cover_sample_of(int x, int y, int slot, std::size_t job, int lane) {
        const SampleVector& vector = vectors_[job];
        const LocalSample sample{vector.x[lane], vector.y[lane], vector.u[lane], vector.v[lane], vector.t[lane]};
        // Samples of another segment of the path are that segment's; no test has to find that out.
        const float fraction = std::fma(sample.t, triangle_.segments, -triangle_.segment);
        if (!(fraction >= 0.0f && fraction < 1.0f)) return;
        if (!keeps(Grain::kTile, sample, 0) || !keeps(Grain::kPixel, sample, lane) || !keeps(Grain::kBucket, sample, 0))
            return;
        ++counts_.tested;
        const SampleHit hit = cover_sample(triangle_, sample, centre_);
        const int px = left_ + x + lane % kBlockSize, py = top_ + y + lane / kBlockSize;
        if (work_.map != nullptr) record(*work_.map, px, py, hit.hit);
        if (!hit.hit) return;
        ++counts_.covered;
        const int block = y / kBlockSize * kCellBlocks + x / kBlockSize;
        const std::size_t entry = shown_.first(block) + static_cast<std::size_t>(slot) * kLanes + lane;
        if (found_(triangle_, hit, SamplePlace{entry, px, py, slot, lane})) changed_ |= std::uint64_t{1} << block;
    }

    // Of the blocks that show something else than at the last call.
    void update_occluders() {
        for (std::uint64_t left = changed_; left != 0; left &= left - 1) update_block(std::countr_zero(left));
        if (changed_ != 0) occluders_.finish();
        changed_ = 0;
    }

    void update_block(int block) {
        const int x = block % kCellBlocks * kBlockSize + left_, y = block / kCellBlocks * kBlockSize + top_;
        const Tile& tile = work_.tile;
        float farthest[Occluders::kTimes] = {};
        for (int lane = 0; lane < kLanes; ++lane) {
            const int px = x + lane % kBlockSize, py = y + lane / kBlockSize;
            if (px < tile.x0 || px >= tile.x1 || py < tile.y0 || py >= tile.y1) continue;
            if (!tile.wants(px / kBlockSize, py / kBlockSize)) continue;
            for (int slot = 0; slot < slots_; ++slot) {
                const std::size_t job = static_cast<std::size_t>(block) * slots_ + slot;
                float& depth = farthest[Occluders::time_of(vectors_[job].t[lane])];
                depth = std::max(depth, shown_.depth[shown_.entry(px, py, slot)]);
            }
        }
        for (int time = 0; time < Occluders::kTimes; ++time)
            occluders_.set(block % kCellBlocks, kCellBlocks - 1 - block / kCellBlocks, time, farthest[time]);
    }

    static void record(CoverMap& map, int px, int py, bool hit) {
        const std::size_t pixel = static_cast<std::size_t>(py) * map.width + px;
        ++map.tested[pixel];
        map.covered[pixel] += hit;
    }

    const TileWork& work_;
    const Hits& shown_;
    CoverCounts& counts_;
    Found& found_;
    CellCentre centre_;
    int left_, top_, slots_;          // of the cell in the picture
    std::vector<SampleVector> room_;  // before vectors_, which may point into it
    std::span<const SampleVector> vectors_;
    Domain whole_;
    Footprint picture_;
    int first_step_[scalar_walk::kGrainCount] = {}, step_count_[scalar_walk::kGrainCount] = {};
    std::vector<scalar_walk::Step> steps_;  // tiles, pixels, buckets
    std::vector<Footprint> buckets_;
    LocalTriangle triangle_;
    scalar_walk::Rect pixels_{};  // the triangle's in this tile
    bool asks_occluders_ = false;
    Occluders occluders_;
    std::uint64_t changed_ = ~std::uint64_t{0};  // blocks, since the last update of occluders_
};

}  // namespace pentaprism
