// The Reyes way (Cook, Carpenter, Catmull 1987): each triangle is diced to micropolygons of about a pixel, each of
// which is bounded and tested against samples. With motion and defocus, after Fatahalian et al. 2009: a micropolygon is
// bounded for each stratum of lens and shutter by itself, and the stratum's samples within are tested.
//
// What is found is the triangle, not the micropolygon: its number, and the surface's opacity at the triangle's own
// barycentric coordinates. So everything after visibility is the same as for the other methods. Depths are those of the
// micropolygon's own plane, the same up to rounding. Triangles come front to back.
//
// Culling has two levels (docs/develop/algorithms.md 7.2). A group of about 16 micropolygons is bounded for each
// stratum first: blocks of 4x4 pixels that it does not touch, or in which it lies behind all that they show, and strata
// that are left with no block are not asked about again by any of its micropolygons. Then each micropolygon is.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "cover/cover.h"
#include "cover/dice.h"
#include "cover/exact.h"
#include "cover/micropolygon_kernels.h"
#include "frame/opacity.h"

namespace pentaprism {
namespace {

struct SlotBlocks {
    std::uint16_t slot;
    std::uint64_t blocks;
};

constexpr std::uint64_t kAllBlocks = ~std::uint64_t{0};

// The strata that micropolygons are asked about, and the blocks for each of them.
struct Asked {
    std::vector<std::uint16_t> strata;
    std::vector<Domain> domains;        // of each
    std::vector<std::uint64_t> blocks;  // of each
    std::uint64_t all_blocks = 0;       // of any

    void clear() {
        strata.clear();
        domains.clear();
        blocks.clear();
        all_blocks = 0;
    }
    void add(std::size_t stratum, const Domain& domain, std::uint64_t of_stratum) {
        strata.push_back(static_cast<std::uint16_t>(stratum));
        domains.push_back(domain);
        blocks.push_back(of_stratum);
        all_blocks |= of_stratum;
    }
};

class MicropolygonTile {
  public:
    MicropolygonTile(const TileWork& work, Hits& hits, CoverCounts& counts)
        : work_(work),
          hits_(hits),
          counts_(counts),
          kernels_(micropolygon_kernels()),
          centre_(cell_centre(work.frame.view, work.tile.cell_x(), work.tile.cell_y())),
          dicer_(centre_, work.frame.view.lens.ratio),
          samples_(work.samples.cell(work.tile.cell_x(), work.tile.cell_y(), sample_room_).data()),
          domains_(work.samples.domains(work.tile.cell_x(), work.tile.cell_y(), domain_room_)),
          slots_(work.samples.slots()),
          wanted_(work.tile.wanted_blocks()),
          by_stratum_(domains_.size()),
          boxes_(domains_.size()) {
        for (std::size_t stratum = 0; stratum < domains_.size(); ++stratum)
            all_.add(stratum, domains_[stratum], kAllBlocks);
        for (const Stratum& s : work.samples.strata(work.tile.cell_x(), work.tile.cell_y()))
            by_stratum_[s.stratum].push_back({s.slot, s.blocks});
        const Tile& tile = work.tile;
        const float left = static_cast<float>(tile.cell_x() * kCellSize + kCellSize / 2);
        const float top = static_cast<float>(tile.cell_y() * kCellSize + kCellSize / 2);
        window_ = {static_cast<float>(tile.x0) - left, static_cast<float>(tile.x1) - left,
                   top - static_cast<float>(tile.y1), top - static_cast<float>(tile.y0)};
    }

    void cover_all() {
        std::vector<std::uint32_t> order(work_.list.begin(), work_.list.end());
        std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
            const float wa = work_.triangles[a].nearest_w, wb = work_.triangles[b].nearest_w;
            return wa < wb || (wa == wb && a < b);
        });
        farthest_.fill(INFINITY);
        constexpr int kBetweenUpdates = 32;
        int until_update = kBetweenUpdates;
        for (const std::uint32_t entry : order) {
            const BinnedTriangle& binned = work_.triangles[entry];
            if (shown_blocks(kAllBlocks, binned.nearest_w) == 0) continue;
            const LocalTriangle triangle = localize(work_.frame, binned.triangle, binned.segment, centre_);
            Dicer::Visitor visitor;
            visitor.enter_group = [&](const Micropolygon& group) { return enter_group(group); };
            visitor.visit = [&](const Micropolygon& micro, bool in_group) {
                cover(triangle, micro, in_group ? group_ : all_);
            };
            dicer_.dice(triangle, window_, visitor);
            if (--until_update > 0) continue;
            update_farthest();
            until_update = kBetweenUpdates;
        }
    }

  private:
    // Of `blocks`, those that show something no nearer than w. An orthographic w says nothing about depth; rounding may
    // put a hit a few ulps in front of the nearest corner.
    std::uint64_t shown_blocks(std::uint64_t blocks, float w) const {
        if (!work_.frame.view.perspective) return blocks;
        const float nearest = w * (1.0f - 16.0f * 0x1p-24f);
        std::uint64_t shown = 0;
        for (std::uint64_t m = blocks; m != 0; m &= m - 1)
            if (nearest <= farthest_[std::countr_zero(m)]) shown |= m & -m;
        return shown;
    }

    void update_farthest() {
        const std::size_t n = static_cast<std::size_t>(slots_) * kLanes;
        for (std::uint64_t m = wanted_; m != 0; m &= m - 1) {
            const int block = std::countr_zero(m);
            const float* depths = &hits_.depth[hits_.first(block)];
            farthest_[block] = std::max(0.0f, *std::max_element(depths, depths + n));
        }
    }

    // Which strata and blocks a group may touch. False: none.
    bool enter_group(const Micropolygon& group) {
        group_.clear();
        const std::uint64_t shown = shown_blocks(blocks_of(group.box), group.nearest_w);
        if (shown == 0) return false;
        kernels_.strata_boxes(group, domains_, boxes_.data());
        for (std::size_t stratum = 0; stratum < domains_.size(); ++stratum) {
            const std::uint64_t blocks = blocks_of(boxes_[stratum]) & shown;
            if (blocks != 0) group_.add(stratum, domains_[stratum], blocks);
        }
        return !group_.strata.empty();
    }

    void cover(const LocalTriangle& triangle, const Micropolygon& micro, const Asked& asked) {
        const std::uint64_t shown = shown_blocks(blocks_of(micro.box) & asked.all_blocks, micro.nearest_w);
        if (shown == 0) return;
        kernels_.strata_boxes(micro, asked.domains, boxes_.data());
        jobs_.clear();
        for (std::size_t k = 0; k < asked.strata.size(); ++k)
            list_jobs(k, asked.strata[k], blocks_of(boxes_[k]) & asked.blocks[k] & shown);
        counts_.tested += kernels_.find_lanes(micro.piece, samples_, boxes_.data(), jobs_);
        for (const MicroJob& job : jobs_)
            for (std::uint32_t lanes = job.lanes; lanes != 0; lanes &= lanes - 1)
                cover_sample_of(triangle, micro, job.vector, std::countr_zero(lanes));
    }

    // Blocks of the tile that the box touches.
    std::uint64_t blocks_of(const LocalBox& box) const {
        const float x0 = std::max(box.x0, window_.x0), x1 = std::min(box.x1, window_.x1);
        const float y0 = std::max(box.y0, window_.y0), y1 = std::min(box.y1, window_.y1);
        if (!(x0 <= x1 && y0 <= y1)) return 0;
        constexpr float half = kCellSize / 2;
        const auto block = [](float distance) {
            return std::clamp(static_cast<int>(distance) / kBlockSize, 0, kCellBlocks - 1);
        };
        const int column0 = block(x0 + half), column1 = block(x1 + half);
        const int row0 = block(half - y1), row1 = block(half - y0);
        std::uint64_t blocks = 0;
        for (int row = row0; row <= row1; ++row)
            blocks |= ((0xffull >> (7 - column1)) & (0xffull << column0)) << (8 * row);
        return blocks & wanted_;
    }

    // The vectors of the stratum in those blocks.
    void list_jobs(std::size_t box, std::size_t stratum, std::uint64_t blocks) {
        for (const SlotBlocks& s : by_stratum_[stratum])
            for (std::uint64_t m = blocks & s.blocks; m != 0; m &= m - 1)
                jobs_.push_back({static_cast<std::uint32_t>(std::countr_zero(m) * slots_ + s.slot),
                                 static_cast<std::uint16_t>(box), 0});
    }

    void cover_sample_of(const LocalTriangle& triangle, const Micropolygon& micro, std::uint32_t vector, int lane) {
        const int block = static_cast<int>(vector) / slots_, slot = static_cast<int>(vector) % slots_;
        const int bx = work_.tile.cell_x() * kCellBlocks + block % kCellBlocks;
        const int by = work_.tile.cell_y() * kCellBlocks + block / kCellBlocks;
        const int px = bx * kBlockSize + lane % kBlockSize, py = by * kBlockSize + lane / kBlockSize;
        const Tile& tile = work_.tile;
        if (px < tile.x0 || px >= tile.x1 || py < tile.y0 || py >= tile.y1) return;
        const SampleVector& v = samples_[vector];
        const LocalSample sample{v.x[lane], v.y[lane], v.u[lane], v.v[lane], v.t[lane]};
        const SampleHit hit = cover_sample(micro.piece, sample, centre_);
        if (!hit.hit) return;
        ++counts_.covered;
        const std::size_t at = hits_.first(block) + static_cast<std::size_t>(slot) * kLanes + lane;
        const bool nearer =
            hit.depth < hits_.depth[at] || (hit.depth == hits_.depth[at] && triangle.triangle < hits_.triangle[at]);
        if (!nearer) return;
        if (triangle.alpha_tested) {
            const SampleHit of_triangle = project_sample(triangle, sample);
            const int index = work_.samples.indices(bx, by)[static_cast<std::size_t>(slot) * kLanes + lane];
            if (!is_opaque_at(work_.frame, triangle.triangle, of_triangle.barycentrics, px, py, index, work_.samples))
                return;
        }
        hits_.depth[at] = hit.depth;
        hits_.triangle[at] = triangle.triangle;
    }

    const TileWork& work_;
    Hits& hits_;
    CoverCounts& counts_;
    MicropolygonKernels kernels_;
    CellCentre centre_;
    Dicer dicer_;
    std::vector<SampleVector> sample_room_;
    std::vector<Domain> domain_room_;
    const SampleVector* samples_;      // of the cell
    std::span<const Domain> domains_;  // of its strata
    int slots_;
    std::uint64_t wanted_;  // blocks
    std::vector<std::vector<SlotBlocks>> by_stratum_;
    Asked all_, group_;
    std::vector<LocalBox> boxes_;  // of the strata that are asked about
    std::vector<MicroJob> jobs_;
    std::array<float, kBlocksPerCell> farthest_{};  // no smaller than any depth of the block
    LocalBox window_{};                             // the tile
};

}  // namespace

void cover_micropolygons(const TileWork& work, Hits& hits, CoverCounts& counts) {
    MicropolygonTile(work, hits, counts).cover_all();
}

}  // namespace pentaprism
