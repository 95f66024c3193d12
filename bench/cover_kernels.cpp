// This file is compiled once for each CPU target, as cover/cover_vectors.cpp is.

#include "cover_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cover_kernels.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <hwy/highway.h>

#include "cover/front_to_back.h"

#if HWY_TARGET != HWY_SCALAR
#include "cover/blur_batch-inl.h"
#include "cover/half_planes-inl.h"
#include "cover/lanes-inl.h"
#include "cover/vector_test-inl.h"
#include "cover/work_list-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {
namespace {

using AskEdges = std::size_t (*)(TileState&, const Tested&, std::size_t);
using TestExactly = void (*)(TileState&, const Tested&, std::size_t);

// One triangle in one tile.
struct Pair {
    int batch, k;
    LocalTriangle triangle;
    std::uint64_t blocks;
    std::vector<Job> listed, kept;
    AskEdges ask_edges;
    TestExactly test_exactly;
};

template <Moves kMoves, bool kDefocus>
void choose(Pair& pair) {
    pair.ask_edges = keep_within_edges<kMoves, kDefocus, false>;
    pair.test_exactly = pair.triangle.two_sided ? write_hits<Kind<kMoves, kDefocus, Seen::kBoth, false>>
                                                : write_hits<Kind<kMoves, kDefocus, Seen::kFront, false>>;
}

void choose(Pair& pair, bool moves, bool defocus) {
    if (!moves) return defocus ? choose<Moves::kNot, true>(pair) : choose<Moves::kNot, false>(pair);
    if (pair.triangle.segments > 1.0f)
        return defocus ? choose<Moves::kInPieces, true>(pair) : choose<Moves::kInPieces, false>(pair);
    return defocus ? choose<Moves::kStraight, true>(pair) : choose<Moves::kStraight, false>(pair);
}

class RecordedTile {
  public:
    RecordedTile(const Frame& frame, const SampleTable& samples, const Bins& bins, const Tile& tile)
        : work_{frame, samples, bins.triangles(), bins.tile(tile.x0, tile.y0), tile},
          of_table_((hits_.reset(samples.slots(), tile), work_)),
          state_(work_, of_table_.arrangement, hits_, counts_) {
        open(samples);
        const std::vector<std::uint32_t> order = front_to_back(work_);
        for (std::size_t i = 0; i < order.size(); ++i) {
            if (i % BlurBatch::kSize == 0) batches_.emplace_back();
            const BinnedTriangle& binned = work_.triangles[order[i]];
            append(batches_.back(), frame, binned, nearest_depth(work_, binned));
        }
        set_up();
        for (int b = 0; b < static_cast<int>(batches_.size()); ++b)
            for (int k = 0; k < batches_[b].count; ++k) record(b, k);
    }

    void set_up() {
        for (BlurBatch& batch : batches_) prepare(batch, work_, state_.centre);
    }
    void list() {
        for (const Pair& pair : pairs_) list(pair);
    }
    void ask_half_planes() {
        for (const Pair& pair : pairs_) {
            std::copy(pair.listed.begin(), pair.listed.end(), state_.jobs.begin());
            pair.ask_edges(state_, tested(pair), pair.listed.size());
        }
    }
    void start_depths() { hits_.reset(state_.slots(), work_.tile); }
    void test_exactly() {
        for (const Pair& pair : pairs_) {
            std::copy(pair.kept.begin(), pair.kept.end(), state_.jobs.begin());
            pair.test_exactly(state_, tested(pair), pair.kept.size());
        }
    }

    void count(bench::CoverKernels& kernels) {
        counts_ = {};
        start_depths();
        test_exactly();
        kernels.samples += counts_.tested;
        kernels.covered += counts_.covered;
        for (const Pair& pair : pairs_) {
            ++kernels.triangles;
            kernels.listed += static_cast<std::int64_t>(pair.listed.size());
            kernels.kept += static_cast<std::int64_t>(pair.kept.size());
        }
    }

  private:
    // As cover_tile() does, for a tile that is a whole cell and shows nothing yet.
    void open(const SampleTable& samples) {
        state_.tile_blocks = ~std::uint64_t{0};
        const std::size_t vectors = static_cast<std::size_t>(kBlocksPerCell) * samples.slots();
        state_.farthest.assign(vectors, INFINITY);
        state_.jobs.resize(vectors + kLanes);
    }

    Tested tested(const Pair& pair) const { return {batches_[pair.batch], pair.k, 1, pair.triangle}; }

    std::size_t list(const Pair& pair) {
        const BlurBatch& batch = batches_[pair.batch];
        const StratumLimits limits(state_, batch.segment[pair.k], batch.segments[pair.k]);
        boxes_of_strata(state_, batch.planes, pair.k, limits, state_.masks);
        return list_jobs(state_, state_.masks, pair.blocks, batch.nearest[pair.k]);
    }

    void record(int b, int k) {
        const BlurBatch& batch = batches_[b];
        if (batch.behind[k] != 0) return;
        Pair pair{
            b,  k, local_triangle(batch, k, work_.frame), blocks_of(*batch.binned[k], work_.tile, kBlockSize), {}, {},
            {}, {}};
        choose(pair, batch.moves[k] != 0, batch.defocus[k] != 0);
        const std::size_t listed = list(pair);
        if (listed == 0) return;
        pair.listed.assign(state_.jobs.begin(), state_.jobs.begin() + static_cast<std::ptrdiff_t>(listed));
        const std::size_t kept = pair.ask_edges(state_, tested(pair), listed);
        pair.kept.assign(state_.jobs.begin(), state_.jobs.begin() + static_cast<std::ptrdiff_t>(kept));
        pairs_.push_back(std::move(pair));
    }

    TileWork work_;
    Hits hits_;
    CoverCounts counts_;
    ArrangementOfTable of_table_;
    std::vector<BlurBatch> batches_;
    std::vector<Pair> pairs_;
    TileState state_;  // after what it refers to
};

class Recorded : public bench::CoverKernels {
  public:
    Recorded(const Frame& frame, const SampleTable& samples, const Bins& bins, int stride) {
        int n = 0;
        for (int y = 0; y + kCellSize <= frame.view.height; y += kCellSize)
            for (int x = 0; x + kCellSize <= frame.view.width; x += kCellSize)
                if (n++ % stride == 0)
                    tiles_.push_back(
                        std::make_unique<RecordedTile>(frame, samples, bins, Tile{x, y, x + kCellSize, y + kCellSize}));
        for (const auto& tile : tiles_) tile->count(*this);
    }
    void set_up() override { each(&RecordedTile::set_up); }
    void list() override { each(&RecordedTile::list); }
    void ask_half_planes() override { each(&RecordedTile::ask_half_planes); }
    void start_depths() override { each(&RecordedTile::start_depths); }
    void test_exactly() override { each(&RecordedTile::test_exactly); }

  private:
    void each(void (RecordedTile::*work)()) {
        for (const auto& tile : tiles_) (*tile.*work)();
    }
    std::vector<std::unique_ptr<RecordedTile>> tiles_;
};

}  // namespace

std::unique_ptr<bench::CoverKernels> record(const Frame& frame, const SampleTable& samples, const Bins& bins,
                                            int stride) {
    return std::make_unique<Recorded>(frame, samples, bins, stride);
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();
#endif  // HWY_SCALAR

#if HWY_ONCE
#include "base/cpu_dispatch.h"

namespace pentaprism {
namespace {

std::unique_ptr<bench::CoverKernels> record_for_cpu([[maybe_unused]] const Frame& frame,
                                                    [[maybe_unused]] const SampleTable& samples,
                                                    [[maybe_unused]] const Bins& bins, [[maybe_unused]] int stride) {
    PENTAPRISM_RETURN_FOR_CPU(record(frame, samples, bins, stride));
    return nullptr;
}

}  // namespace

std::unique_ptr<bench::CoverKernels> bench::record_cover_kernels(const Frame& frame, const SampleTable& samples,
                                                                 const Bins& bins, int stride) {
    return record_for_cpu(frame, samples, bins, stride);
}

}  // namespace pentaprism
#endif
