// The Reyes way (Cook, Carpenter, Catmull 1987): each triangle is diced to micropolygons of about a pixel, each of
// which is bounded and tested against samples. With motion and defocus, after Fatahalian et al. 2009: a micropolygon is
// bounded for each stratum of lens and shutter by itself, and the stratum's samples within are tested.
//
// What is found is the triangle, not the micropolygon: its number, and the surface's opacity at the triangle's own
// barycentric coordinates. So everything after visibility is the same as for the other methods. Depths are those of the
// micropolygon's own plane, the same up to rounding.

#include <algorithm>
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

class MicropolygonTile {
  public:
    MicropolygonTile(const TileWork& work, Hits& hits, CoverCounts& counts)
        : work_(work),
          hits_(hits),
          counts_(counts),
          kernels_(micropolygon_kernels()),
          centre_(cell_centre(work.frame.view, work.tile.cell_x(), work.tile.cell_y())),
          dicer_(centre_, work.frame.view.lens.ratio),
          samples_(work.samples.cell(work.tile.cell_x(), work.tile.cell_y(), vector_room_).data()),
          domains_(work.samples.domains(work.tile.cell_x(), work.tile.cell_y(), domain_room_)),
          slots_(work.samples.slots()),
          by_stratum_(domains_.size()),
          boxes_(domains_.size()) {
        for (const SampleTable::Stratum& s : work.samples.strata(work.tile.cell_x(), work.tile.cell_y()))
            by_stratum_[s.stratum].push_back({s.slot, s.blocks});
        const Tile& tile = work.tile;
        const float left = static_cast<float>(tile.cell_x() * kCellSize + kCellSize / 2);
        const float top = static_cast<float>(tile.cell_y() * kCellSize + kCellSize / 2);
        window_ = {static_cast<float>(tile.x0) - left, static_cast<float>(tile.x1) - left,
                   top - static_cast<float>(tile.y1), top - static_cast<float>(tile.y0)};
    }

    void cover_all() {
        for (const std::uint32_t entry : work_.list) {
            const BinnedTriangle& binned = work_.triangles[entry];
            const LocalTriangle triangle = localize(work_.frame, binned.triangle, binned.segment, centre_);
            dicer_.dice(triangle, window_, [&](const Micropolygon& micro) { cover(triangle, micro); });
        }
    }

  private:
    void cover(const LocalTriangle& triangle, const Micropolygon& micro) {
        kernels_.strata_boxes(micro, domains_, boxes_.data());
        jobs_.clear();
        for (std::size_t stratum = 0; stratum < boxes_.size(); ++stratum) list_jobs(stratum);
        counts_.tested += kernels_.find_lanes(micro.piece, samples_, boxes_.data(), jobs_);
        for (const MicroJob& job : jobs_)
            for (std::uint32_t lanes = job.lanes; lanes != 0; lanes &= lanes - 1)
                cover_sample_of(triangle, micro, job.vector, std::countr_zero(lanes));
    }

    // The vectors of the stratum in the blocks that its box touches.
    void list_jobs(std::size_t stratum) {
        const LocalBox& box = boxes_[stratum];
        const float x0 = std::max(box.x0, window_.x0), x1 = std::min(box.x1, window_.x1);
        const float y0 = std::max(box.y0, window_.y0), y1 = std::min(box.y1, window_.y1);
        if (!(x0 <= x1 && y0 <= y1)) return;
        constexpr float half = kCellSize / 2;
        const auto block = [](float distance) {
            return std::clamp(static_cast<int>(distance) / kBlockSize, 0, kCellBlocks - 1);
        };
        const int column0 = block(x0 + half), column1 = block(x1 + half);
        const int row0 = block(half - y1), row1 = block(half - y0);
        std::uint64_t blocks = 0;
        for (int row = row0; row <= row1; ++row)
            blocks |= ((0xffull >> (7 - column1)) & (0xffull << column0)) << (8 * row);
        for (const SlotBlocks& s : by_stratum_[stratum])
            for (std::uint64_t m = blocks & s.blocks; m != 0; m &= m - 1)
                jobs_.push_back({static_cast<std::uint32_t>(std::countr_zero(m) * slots_ + s.slot),
                                 static_cast<std::uint16_t>(stratum), 0});
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
        const std::size_t at = std::size_t{vector} * kLanes + lane;
        if (!(hit.depth < hits_.depth[at])) return;  // triangles come in order: equal depths keep the lower
        if (triangle.alpha_tested) {
            const SampleHit of_triangle = project_sample(triangle, sample);
            const int index = work_.samples.indices(bx, by)[static_cast<std::size_t>(slot) * kLanes + lane];
            if (!is_opaque_at(work_.frame, triangle.triangle, of_triangle.barycentrics, px, py, index,
                              work_.samples.spp()))
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
    std::vector<SampleVector> vector_room_;  // before what may point into it
    std::vector<Domain> domain_room_;
    const SampleVector* samples_;  // of the cell
    std::span<const Domain> domains_;
    int slots_;
    std::vector<std::vector<SlotBlocks>> by_stratum_;
    std::vector<LocalBox> boxes_;  // of each stratum
    std::vector<MicroJob> jobs_;
    LocalBox window_{};  // the tile
};

}  // namespace

void cover_micropolygons(const TileWork& work, Hits& hits, CoverCounts& counts) {
    MicropolygonTile(work, hits, counts).cover_all();
}

}  // namespace pentaprism
