#include "lab/guided_sampling.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "cover/exact.h"
#include "sample/aperture.h"
#include "sample/net.h"

namespace pentaprism {
namespace {

constexpr int kTimes = 8, kQuadrants = 4;
static_assert(kTimes * kQuadrants == kGuideCells);
constexpr std::uint32_t kAllCells = 0xffffffffu;

Domain domain_of(int cell, float ratio) {
    const float t0 = static_cast<float>(cell / kQuadrants) / kTimes;
    const bool right = cell % 2 != 0, up = cell / 2 % 2 != 0;
    return {right ? 0.0f : -1.0f, right ? 1.0f : 0.0f, up ? 0.0f : -ratio, up ? ratio : 0.0f, t0, t0 + 1.0f / kTimes};
}

// Nearest of the triangles that a sample sees.
struct Nearest {
    float depth = std::numeric_limits<float>::infinity();
    std::uint32_t triangle = 0xffffffffu;

    void offer(const LocalTriangle& T, const SampleHit& hit) {
        if (!hit.hit || !(hit.depth < depth || (hit.depth == depth && T.triangle < triangle))) return;
        depth = hit.depth;
        triangle = T.triangle;
    }
    bool hit() const { return depth < std::numeric_limits<float>::infinity(); }
};

}  // namespace

// Random samples of one pixel.
class GuidedSampler::Draw {
  public:
    Draw(const Lens& lens, const GuidedPixel& pixel, std::uint32_t seed) : lens_(lens), pixel_(pixel) {
        lens_.blades = 0;
        lens_.image.reset();
        state_ = mix(
            mix(mix(static_cast<std::uint32_t>(pixel.px) + 0x68bc21ebu) + static_cast<std::uint32_t>(pixel.py)) + seed);
    }
    double unit() {
        state_ += 0x9e3779b9u;
        return mix(state_) * (1.0 / 4294967296.0);
    }
    std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(unit() * n); }

    // Uniform in the cell of lens and shutter, and over the pixel.
    LocalSample in_cell(int cell) {
        SamplePoint point;
        point.x = static_cast<float>(below(256)) / 256.0f;
        point.y = static_cast<float>(below(256)) / 256.0f;
        const double p = 0.5 * (cell % 2 + unit()), q = 0.5 * (cell / 2 % 2 + unit());
        const glm::dvec2 uv = aperture_point(lens_, p, q);
        point.u = static_cast<float>(uv.x);
        point.v = static_cast<float>(uv.y);
        // Of the interval, which is 2^21 steps of 2^-24.
        point.t = static_cast<float>(cell / kQuadrants) / kTimes + static_cast<float>(below(1u << 21)) * 0x1p-24f;
        return local_sample(point, pixel_.px, pixel_.py);
    }
    int cell_of(std::uint32_t cells) {
        for (std::uint32_t skip = below(static_cast<std::uint32_t>(std::popcount(cells))); skip > 0; --skip)
            cells &= cells - 1;
        return std::countr_zero(cells);
    }

  private:
    Lens lens_;
    const GuidedPixel& pixel_;
    std::uint32_t state_;
};

GuidedSampler::GuidedSampler(const Frame& frame, std::vector<glm::vec3> colors, const glm::vec3& background)
    : frame_(frame),
      colors_(std::move(colors)),
      background_(background),
      bins_(frame, kCellSize, {0, frame.view.width, 0, frame.view.height}) {}

GuidedSampler::Cell GuidedSampler::bound(int cx, int cy) const {
    const CullTest& test = *find_cull_test("improved-dual-space");
    const View& view = frame_.view;
    const CellCentre centre = cell_centre(view, cx, cy);
    const auto list = bins_.tile(cx * kCellSize, cy * kCellSize);
    Cell cell;
    cell.triangles.reserve(list.size());
    for (const std::uint32_t entry : list)
        cell.triangles.push_back(
            localize(frame_, bins_.triangles()[entry].triangle, bins_.triangles()[entry].segment, centre));
    CullState state;
    for (int py = cy * kCellSize; py < std::min((cy + 1) * kCellSize, view.height); ++py)
        for (int px = cx * kCellSize; px < std::min((cx + 1) * kCellSize, view.width); ++px) {
            GuidedPixel pixel{px, py, centre, {}};
            constexpr float half = kCellSize / 2;
            const float x = static_cast<float>(px % kCellSize) - half, y = half - static_cast<float>(py % kCellSize);
            for (std::size_t i = 0; i < list.size(); ++i) {
                const BinnedTriangle& binned = bins_.triangles()[list[i]];
                if (px < binned.x0 || px >= binned.x1 || py < binned.y0 || py >= binned.y1) continue;
                std::uint32_t cells = 0;
                for (int k = 0; k < kGuideCells; ++k) {
                    const Footprint footprint{x, x + 1, y - 1, y, domain_of(k, static_cast<float>(view.lens.ratio))};
                    if (test.prepare(cell.triangles[i], footprint, state)) cells |= 1u << k;
                }
                if (cells != 0) pixel.candidates.push_back({&cell.triangles[i], cells});
            }
            cell.pixels.push_back(std::move(pixel));
        }
    return cell;
}

glm::dvec3 GuidedSampler::estimate(Guidance guidance, const GuidedPixel& pixel, int samples, std::uint32_t seed,
                                   std::int64_t& tests) const {
    Draw draw(frame_.view.lens, pixel, seed);
    const auto try_triangle = [&](const Candidate& candidate, const LocalSample& sample, Nearest& nearest) {
        ++tests;
        nearest.offer(*candidate.triangle, cover_sample(*candidate.triangle, sample, pixel.centre));
    };
    // Of all candidates whose bounds hold the cell.
    const auto look = [&](int cell, const LocalSample& sample, bool guided) {
        Nearest nearest;
        for (const Candidate& candidate : pixel.candidates)
            if (!guided || (candidate.cells >> cell & 1u) != 0) try_triangle(candidate, sample, nearest);
        return nearest;
    };
    const auto shown = [&](const Nearest& nearest) {
        return glm::dvec3(nearest.hit() ? colors_[nearest.triangle] : background_);
    };
    glm::dvec3 sum(0.0);
    switch (guidance) {
        case Guidance::kUnguided:
        case Guidance::kEnumerated:
            for (int i = 0; i < samples; ++i) {
                // Each cell in turn: stratified as well as random samples can be.
                const int cell = i < samples / kGuideCells * kGuideCells ? i % kGuideCells : draw.cell_of(kAllCells);
                const LocalSample sample = draw.in_cell(cell);
                sum += shown(look(cell, sample, guidance == Guidance::kEnumerated)) / static_cast<double>(samples);
            }
            return sum;

        case Guidance::kPrivate: {
            // A triangle has a sample in a slot with the probability that its bounds have: alone, it is estimated
            // without bias. A slot compares the depths of samples that lie at different lens positions and times.
            std::vector<Nearest> slots(static_cast<std::size_t>(samples));
            for (const Candidate& candidate : pixel.candidates)
                for (Nearest& slot : slots)
                    if (draw.unit() * kGuideCells < std::popcount(candidate.cells))
                        try_triangle(candidate, draw.in_cell(draw.cell_of(candidate.cells)), slot);
            for (const Nearest& slot : slots) sum += shown(slot) / static_cast<double>(samples);
            return sum;
        }

        case Guidance::kStrata: {
            // Cell k has n_k >= 1 samples, by how many bounds overlap there; not by what samples find, hence no bias.
            std::array<int, kGuideCells> overlap{};
            int overlaps = 0;
            for (const Candidate& candidate : pixel.candidates)
                for (int k = 0; k < kGuideCells; ++k) overlap[k] += static_cast<int>(candidate.cells >> k & 1u);
            for (const int n : overlap) overlaps += n;
            const int spare = samples - kGuideCells;
            int used = 0, passed = 0;
            for (int k = 0; k < kGuideCells; ++k) {
                passed += overlaps > 0 ? overlap[k] : 1;
                const int until = static_cast<int>(static_cast<std::int64_t>(spare) * passed /
                                                   (overlaps > 0 ? overlaps : kGuideCells));
                const int n = 1 + until - used;
                used = until;
                for (int i = 0; i < n; ++i)
                    sum += shown(look(k, draw.in_cell(k), true)) / static_cast<double>(kGuideCells * n);
            }
            return sum;
        }

        case Guidance::kTraced: {
            // Each sample of a triangle stands for a share of its bounds' volume; it counts where the triangle is what
            // that sample really sees. What no triangle takes is the background's.
            double covered = 0.0;
            for (const Candidate& candidate : pixel.candidates) {
                const int cells = std::popcount(candidate.cells), n = std::max(1, samples * cells / kGuideCells);
                const double weight = static_cast<double>(cells) / kGuideCells / n;
                for (int i = 0; i < n; ++i) {
                    const int cell = draw.cell_of(candidate.cells);
                    const LocalSample sample = draw.in_cell(cell);
                    Nearest own;
                    try_triangle(candidate, sample, own);
                    if (!own.hit() || look(cell, sample, true).triangle != own.triangle) continue;
                    sum += glm::dvec3(colors_[own.triangle]) * weight;
                    covered += weight;
                }
            }
            return sum + glm::dvec3(background_) * (1.0 - covered);
        }
    }
    return sum;
}

}  // namespace pentaprism
