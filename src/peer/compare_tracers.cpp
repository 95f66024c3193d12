#include "peer/compare_tracers.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <pentaprism/error.h>
#include <tuple>

#include "base/parallel.h"

namespace pentaprism {
namespace {

/// SplitMix64's finalizer: which samples belong to the subset is a pure function of their place.
std::uint64_t scatter(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

class Subset {
  public:
    Subset(std::int64_t wanted, std::int64_t samples)
        : all_(wanted >= samples),
          threshold_(samples > 0
                         ? static_cast<std::uint64_t>(std::ldexp(
                               static_cast<double>(std::min(wanted, samples)) / static_cast<double>(samples), 63))
                         : 0) {}
    bool contains(std::uint64_t sample) const { return all_ || (scatter(sample + 1) >> 1) < threshold_; }

  private:
    bool all_;
    std::uint64_t threshold_;
};

std::vector<Tile> tiles_of(const View& view, int tile_size) {
    std::vector<Tile> tiles;
    for (int y = 0; y < view.height; y += tile_size) {
        for (int x = 0; x < view.width; x += tile_size) {
            tiles.push_back({x, y, std::min(x + tile_size, view.width), std::min(y + tile_size, view.height)});
        }
    }
    return tiles;
}

/// What one tile contributes; joined in the order of tiles, so that the report does not depend on threads.
struct TileFindings {
    std::vector<Claim> disagreements;  // with the reference, in triangle or depth
    std::vector<Claim> brute_force;    // samples of the subset
    double worst_depth_error = 0.0;
};

/// Compares the samples of one tile.
class TileComparison {
  public:
    TileComparison(const Frame& frame, const SampleTable& table, bool has_reference, const Subset& subset)
        : frame_(frame), table_(table), has_reference_(has_reference), subset_(subset) {}

    TileFindings run(const Tile& tile, const Hits& ours, const Hits& theirs) const {
        TileFindings findings;
        for (int by = tile.y0 / kBlockSize; by * kBlockSize < tile.y1; ++by) {
            for (int bx = tile.x0 / kBlockSize; bx * kBlockSize < tile.x1; ++bx) {
                compare_block(tile, bx, by, ours, theirs, findings);
            }
        }
        return findings;
    }

  private:
    void compare_block(const Tile& tile, int bx, int by, const Hits& ours, const Hits& theirs,
                       TileFindings& findings) const {
        const int spp = table_.spp(), slots = table_.slots();
        const std::span<const std::uint16_t> indices = table_.indices(bx, by);
        for (int slot = 0; slot < slots; ++slot) {
            for (int lane = 0; lane < kLanes; ++lane) {
                const int px = bx * kBlockSize + lane % kBlockSize, py = by * kBlockSize + lane / kBlockSize;
                if (px >= tile.x1 || py >= tile.y1) continue;
                const std::size_t i = ours.entry(px, py, slot);
                const Claim claim{px, py, indices[static_cast<std::size_t>(slot) * kLanes + lane], ours.triangle[i],
                                  ours.depth[i]};
                const std::uint64_t pixel = static_cast<std::uint64_t>(py) * frame_.view.width + px;
                if (subset_.contains(pixel * spp + claim.index)) findings.brute_force.push_back(claim);
                if (!has_reference_) continue;
                if (claim.triangle != theirs.triangle[i] ||
                    relative_difference(claim.depth, theirs.depth[i]) > kDepthTolerance) {
                    findings.disagreements.push_back(claim);
                } else if (claim.triangle != kNoTriangle) {
                    note_depth_error(claim, findings);
                }
            }
        }
    }

    /// Both say the same triangle: how far is our depth from that triangle's in double?
    void note_depth_error(const Claim& claim, TileFindings& findings) const {
        const PlacedSample sample = place_sample(frame_.view, table_, claim.px, claim.py, claim.index);
        const ExactHit exact = cover_in_double(frame_, claim.triangle, sample);
        if (exact.hit()) {
            findings.worst_depth_error =
                std::max(findings.worst_depth_error, relative_difference(claim.depth, exact.depth));
        }
    }

    const Frame& frame_;
    const SampleTable& table_;
    bool has_reference_;
    const Subset& subset_;
};

/// Sums verdicts into a report.
class Tally {
  public:
    Tally(VerifyReport& report, const std::function<void(const Verdict&)>& on_disagreement)
        : report_(report), on_disagreement_(on_disagreement) {}

    void add(const Verdict& verdict) {
        ++report_.disagreements;
        if (verdict.depth_tie) ++report_.depth_ties;
        if (verdict.claim.triangle == verdict.truth.triangle && verdict.truth.hit()) {
            report_.worst_depth_error = std::max(report_.worst_depth_error, verdict.depth_difference);
        }
        if (on_disagreement_) on_disagreement_(verdict);
        if (!verdict.wrong) return;
        ++report_.ours_wrong;
        if (verdict.away_from_edge()) ++report_.away_from_edge;
        // Where depths are equal it is not the edge that decides, and the distance to it says nothing.
        if (verdict.depth_difference > kDepthTolerance) {
            report_.worst_margin = std::max(report_.worst_margin, verdict.margin);
        }
    }

  private:
    VerifyReport& report_;
    const std::function<void(const Verdict&)>& on_disagreement_;
};

bool same_sample(const Claim& a, const Claim& b) {
    return a.px == b.px && a.py == b.py && a.index == b.index;
}

bool before(const Claim& a, const Claim& b) {
    return std::tie(a.py, a.px, a.index) < std::tie(b.py, b.px, b.index);
}

}  // namespace

VerifyReport compare_tracers(const Frame& frame, const SampleTable& table, const TileTracer& ours,
                             const TileTracer& reference, const CompareOptions& options, const Progress& progress) {
    const View& view = frame.view;
    VerifyReport report;
    report.width = view.width;
    report.height = view.height;
    report.spp = table.spp();
    report.samples = static_cast<std::int64_t>(view.width) * view.height * table.spp();

    const Subset subset(options.brute_force_samples, report.samples);
    const std::vector<Tile> tiles = tiles_of(view, options.tile_size);
    std::vector<TileFindings> findings(tiles.size());
    const TileComparison comparison(frame, table, static_cast<bool>(reference), subset);
    std::mutex mutex;
    std::size_t done = 0;
    std::atomic<bool> stopped{false};
    // Tracing is most of the work, brute force most of the rest; judging is brief.
    const auto advance = [&](double from, double to, std::size_t n) {
        const std::lock_guard<std::mutex> lock(mutex);
        ++done;
        if (progress && !stopped &&
            !progress(from + (to - from) * static_cast<double>(done) / static_cast<double>(n))) {
            stopped = true;
        }
    };
    parallel_for(tiles.size(), [&](std::size_t i) {
        if (stopped) return;
        Hits mine, theirs;
        mine.reset(table.slots(), tiles[i]);
        ours(tiles[i], mine);
        if (reference) {
            theirs.reset(table.slots(), tiles[i]);
            reference(tiles[i], theirs);
        }
        findings[i] = comparison.run(tiles[i], mine, theirs);
        advance(0.0, 0.7, tiles.size());
    });
    if (stopped) throw Error(ErrorKind::kRender, "interrupted");

    std::vector<Claim> disagreements, subset_claims;
    for (const TileFindings& tile : findings) {
        disagreements.insert(disagreements.end(), tile.disagreements.begin(), tile.disagreements.end());
        subset_claims.insert(subset_claims.end(), tile.brute_force.begin(), tile.brute_force.end());
        report.worst_depth_error = std::max(report.worst_depth_error, tile.worst_depth_error);
    }

    const Judge judge(frame, table);
    Tally tally(report, options.on_disagreement);
    for (const Verdict& verdict : judge.judge(disagreements)) tally.add(verdict);

    // The subset meets every triangle of the scene, with no prefilter. A sample is counted once.
    std::sort(disagreements.begin(), disagreements.end(), before);
    std::vector<Verdict> exact(subset_claims.size());
    done = 0;
    parallel_for(subset_claims.size(), [&](std::size_t i) {
        if (stopped) return;
        const Claim& claim = subset_claims[i];
        const PlacedSample sample = place_sample(view, table, claim.px, claim.py, claim.index);
        exact[i] = judge.compare(claim, nearest_in_double(frame, sample));
        advance(0.7, 1.0, subset_claims.size());
    });
    if (stopped) throw Error(ErrorKind::kRender, "interrupted");
    report.brute_force_samples = static_cast<std::int64_t>(exact.size());
    for (const Verdict& verdict : exact) {
        const bool differs =
            verdict.claim.triangle != verdict.truth.triangle || verdict.depth_difference > kDepthTolerance;
        if (differs) ++report.brute_force_disagreements;
        const auto known = std::lower_bound(disagreements.begin(), disagreements.end(), verdict.claim, before);
        if (differs && (known == disagreements.end() || !same_sample(*known, verdict.claim))) {
            tally.add(verdict);
        } else if (!differs && verdict.truth.hit()) {
            report.worst_depth_error = std::max(report.worst_depth_error, verdict.depth_difference);
        }
    }
    report.per_million =
        report.samples ? 1e6 * static_cast<double>(report.ours_wrong) / static_cast<double>(report.samples) : 0.0;
    return report;
}

}  // namespace pentaprism
