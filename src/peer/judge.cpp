// Judging needs the nearest of all triangles, but only those whose screen bounds reach the sample's neighbourhood can
// be it. The bounds here are plain on purpose: vertices at all knots with their whole circle of confusion, which holds
// because a quotient of affine functions has its extremes at the ends (docs/develop/algorithms.md 3.2); a triangle that
// comes nearer than the near plane is a candidate everywhere.

#include "peer/judge.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace pentaprism {
namespace {

constexpr int kGrid = 16;  // pixels a side of the cells for which candidates are listed
constexpr float kEverywhere = 1e9f;

/// Wider than the rounding of the box itself.
float down(double value) {
    return static_cast<float>(value - 1e-3 - 1e-6 * std::abs(value));
}
float up(double value) {
    return static_cast<float>(value + 1e-3 + 1e-6 * std::abs(value));
}

}  // namespace

double relative_difference(double a, double b) {
    if (a == b) return 0.0;
    const double difference = std::abs(a - b) / std::min(std::abs(a), std::abs(b));
    return std::isnan(difference) ? std::numeric_limits<double>::infinity() : difference;
}

Judge::Judge(const Frame& frame, const SampleTable& table) : frame_(frame), table_(table) {
    boxes_.resize(frame.triangle_count());
    parallel_ranges(boxes_.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) boxes_[i] = bounds(static_cast<std::uint32_t>(i));
    });
}

Judge::Box Judge::bounds(std::uint32_t triangle) const {
    const Part& part = frame_.parts[frame_.part_of[triangle]];
    const double lens_x = 1.0, lens_y = std::max(1.0, frame_.view.lens.ratio), w_near = frame_.view.w_near();
    const int knots = part.moves ? part.segments + 1 : 1;
    Box box{kEverywhere, -kEverywhere, kEverywhere, -kEverywhere};
    for (int i = 0; i < 3; ++i) {
        for (int knot = 0; knot < knots; ++knot) {
            const std::size_t point =
                frame_.corners[3 * std::size_t{triangle} + i] + static_cast<std::size_t>(knot) * part.vertex_count;
            const glm::dvec4 p(frame_.points[point]);
            if (!(p.z >= w_near)) return {-kEverywhere, kEverywhere, -kEverywhere, kEverywhere};
            const double cx = lens_x * std::abs(p.w), cy = lens_y * std::abs(p.w);
            box.x0 = std::min(box.x0, down((p.x - cx) / p.z));
            box.x1 = std::max(box.x1, up((p.x + cx) / p.z));
            box.y0 = std::min(box.y0, down((p.y - cy) / p.z));
            box.y1 = std::max(box.y1, up((p.y + cy) / p.z));
        }
    }
    return box;
}

Verdict Judge::compare(const Claim& claim, const ExactHit& truth) const {
    Verdict verdict{claim, truth};
    verdict.depth_difference = relative_difference(claim.depth, truth.depth);
    const bool claims_hit = claim.triangle != kNoTriangle;
    const PlacedSample sample = place_sample(frame_.view, table_, claim.px, claim.py, claim.index);
    if (claim.triangle == truth.triangle) {
        verdict.wrong = verdict.depth_difference > kDepthTolerance;
    } else {
        verdict.wrong = true;
        if (claims_hit && truth.hit()) {
            // Both cover the sample and only their order is in question: then depth decides, as far as floats can.
            const ExactHit claimed = cover_in_double(frame_, claim.triangle, sample);
            if (claimed.hit() && is_opaque(frame_, claim.triangle, sample)) {
                verdict.tie_gap = relative_difference(claimed.depth, truth.depth);
                verdict.depth_tie = verdict.tie_gap <= kDepthTie;
            }
            verdict.wrong = !verdict.depth_tie || verdict.depth_difference > kDepthTolerance;
        }
    }
    verdict.margin = std::numeric_limits<double>::infinity();
    if (claims_hit) verdict.margin = distance_to_outline(frame_, claim.triangle, sample);
    if (truth.hit()) verdict.margin = std::min(verdict.margin, distance_to_outline(frame_, truth.triangle, sample));
    return verdict;
}

std::vector<Verdict> Judge::judge(std::span<const Claim> claims) const {
    const View& view = frame_.view;
    const int columns = (view.width + kGrid - 1) / kGrid, rows = (view.height + kGrid - 1) / kGrid;

    // Claims by grid cell, and for each cell that has any the triangles that reach it.
    std::vector<int> slot_of(static_cast<std::size_t>(columns) * rows, -1);
    std::vector<std::vector<std::size_t>> claims_of;
    for (std::size_t i = 0; i < claims.size(); ++i) {
        int& slot = slot_of[static_cast<std::size_t>(claims[i].py / kGrid) * columns + claims[i].px / kGrid];
        if (slot < 0) {
            slot = static_cast<int>(claims_of.size());
            claims_of.emplace_back();
        }
        claims_of[slot].push_back(i);
    }
    std::vector<std::vector<std::uint32_t>> candidates_of(claims_of.size());
    if (!claims.empty()) {
        const auto column = [&](float x) {
            return static_cast<int>(
                std::clamp(std::floor((x + 0.5f * view.width) / kGrid), -1.0f, static_cast<float>(columns)));
        };
        const auto row = [&](float y) {
            return static_cast<int>(
                std::clamp(std::floor((0.5f * view.height - y) / kGrid), -1.0f, static_cast<float>(rows)));
        };
        for (std::uint32_t triangle = 0; triangle < boxes_.size(); ++triangle) {
            const Box& box = boxes_[triangle];
            const int column1 = std::min(column(box.x1), columns - 1), row1 = std::min(row(box.y0), rows - 1);
            for (int r = std::max(row(box.y1), 0); r <= row1; ++r) {
                for (int c = std::max(column(box.x0), 0); c <= column1; ++c) {
                    const int slot = slot_of[static_cast<std::size_t>(r) * columns + c];
                    if (slot >= 0) candidates_of[slot].push_back(triangle);
                }
            }
        }
    }

    std::vector<Verdict> verdicts(claims.size());
    parallel_for(claims_of.size(), [&](std::size_t slot) {
        for (const std::size_t i : claims_of[slot]) {
            const PlacedSample sample = place_sample(view, table_, claims[i].px, claims[i].py, claims[i].index);
            verdicts[i] = compare(claims[i], nearest_in_double(frame_, candidates_of[slot], sample));
        }
    });
    return verdicts;
}

}  // namespace pentaprism
