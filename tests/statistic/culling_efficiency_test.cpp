// The sample test efficiency (covered / tested) of each culling test on random triangles is what was published for them
// or measured before, test by test and kind of blur by kind of blur: a bound that has become looser, or tighter than it
// can be, shows.
//
// 256x256 pixels, 16 samples a pixel: 4x4 cells in the pixel, 4x4 cells of the lens, 16 parts of the shutter, paired by
// fresh permutations for each pixel; a disk lens; triangles of 5, 16 and 64 pixels, about 40 pixels of motion, about 16
// pixels of circle of confusion.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <numeric>
#include <string>
#include <tbb/parallel_for.h>
#include <vector>

#include "bin/bins.h"
#include "bound/facing.h"
#include "cover/exact.h"
#include "cull/cull_choice.h"
#include "support/random.h"
#include "support/visible.h"

namespace pentaprism {
namespace {

using support::Random;

constexpr int kSize = 256, kSpp = 16;
constexpr double kFocus = 4, kNear = 0.1;

struct Workload {
    const char* name;
    double size;
    bool motion, defocus;
    double blur = 1;  // times the usual shift and lens radius
};
constexpr Workload kWorkloads[] = {{"still 5", 5, false, false},         {"still 16", 16, false, false},
                                   {"still 64", 64, false, false},       {"motion 5", 5, true, false},
                                   {"motion 16", 16, true, false},       {"motion 64", 64, true, false},
                                   {"defocus 5", 5, false, true},        {"defocus 16", 16, false, true},
                                   {"defocus 64", 64, false, true},      {"both 5", 5, true, true},
                                   {"both 16", 16, true, true},          {"both 64", 64, true, true},
                                   {"both 16, twice", 16, true, true, 2}};
constexpr std::size_t kColumns = std::size(kWorkloads);

// Percent, of an independent implementation. A value below 2 % is too rare an event to be compared closely.
struct Row {
    const char* culling;
    std::array<double, kColumns> efficiency;
    bool of_one_side = false;  // a triangle of which both sides may be seen is not asked about
};
constexpr Row kRows[] = {
    {"bbox", {27.8, 36.6, 40.5, 1.0, 5.6, 20.3, 0.6, 3.7, 16.3, 0.2, 1.7, 10.2, 0.5}},
    {"hull", {44.9, 73.8, 92.0, 3.4, 11.8, 36.1, 0.6, 4.4, 22.2, 0.3, 2.2, 13.7, 0.7}},
    {"dual-space", {27.8, 36.6, 40.5, 28.2, 37.1, 41.1, 27.9, 36.7, 39.7, 1.8, 8.7, 24.6, 3.6}},
    {"dual-space@tile", {27.8, 36.6, 40.5, 6.6, 19.6, 34.0, 5.8, 18.2, 32.4, 1.0, 5.9, 20.7, 2.8}},
    {"improved-dual-space", {27.8, 36.6, 40.5, 28.2, 37.2, 41.1, 27.9, 36.7, 39.7, 27.1, 35.9, 39.3, 32.6}},
    {"improved-dual-space@tile", {27.8, 36.6, 40.5, 6.6, 19.6, 34.0, 5.8, 18.2, 32.4, 5.3, 17.1, 31.6, 16.1}},
    {"improved-dual-space-as-printed", {27.8, 36.6, 40.5, 6.6, 19.4, 33.3, 5.8, 18.1, 31.5, 5.3, 16.8, 29.2, 15.2}},
    {"clip-space-affine", {27.8, 36.6, 40.5, 28.2, 37.2, 41.1, 27.9, 36.7, 39.7, 18.7, 31.3, 37.6, 25.2}},
    {"clip-space-affine@tile", {27.8, 36.6, 40.5, 6.6, 19.6, 34.0, 5.8, 18.2, 32.4, 4.5, 15.6, 30.4, 13.4}},
    {"clip-space", {27.8, 36.6, 40.5, 28.4, 37.1, 40.6, 28.5, 37.6, 40.8, 20.8, 31.7, 37.6, 28.3}},
    {"ut-vt-lines", {27.8, 36.6, 40.5, 6.6, 19.6, 34.0, 5.8, 18.2, 32.4, 3.5, 13.5, 28.6, 10.2}},
    {"improved-dual-space@tile+hyperplane",
     {98.9, 99.9, 100.0, 67.5, 80.2, 89.7, 55.4, 77.1, 90.5, 9.7, 29.0, 56.9, 21.0}},
    {"half-space", {28.3, 40.4, 64.0, 1.1, 6.5, 27.7, 3.5, 17.9, 48.3, 0.5, 3.6, 19.6, 1.2}, true},
    {"improved-dual-space@pixel+hyperplane",
     {98.9, 99.9, 100.0, 69.1, 80.9, 89.9, 61.3, 78.8, 90.7, 28.5, 42.6, 60.7, 35.4}},
    {"improved-dual-space@tile+improved-dual-space",
     {27.8, 36.6, 40.5, 28.2, 37.2, 41.1, 27.9, 36.7, 39.7, 27.1, 35.9, 39.3, 32.6}},
    {"interval", {27.8, 36.6, 40.5, 6.3, 18.9, 33.7, 1.7, 8.7, 24.6, 1.1, 6.1, 21.1, 2.4}},
    {"interval-fine", {27.8, 36.6, 40.5, 17.1, 30.8, 39.3, 4.5, 16.1, 31.3, 3.7, 14.1, 30.0, 7.3}},
};
constexpr std::size_t kRowCount = std::size(kRows);

double normal(Random& r) {
    return std::sqrt(-2 * std::log(1 - r.unit())) * std::cos(2 * std::numbers::pi * r.unit());
}

Frame random_triangle(Random& r, const Workload& work) {
    constexpr double kTwoPi = 2 * std::numbers::pi, kPerNdc = kSize / 2;
    // |c|/w is about 16 pixels in the mean.
    const double a = work.defocus ? -work.blur * 16 / 0.11 : 0, b = -a / kFocus;
    const double x = r.range(-0.5, 0.5) * kPerNdc, y = r.range(-0.5, 0.5) * kPerNdc;
    double depth = kFocus;
    while (std::abs(depth - kFocus) < 0.2) depth = r.range(2, 10);
    const double theta = r.range(0, kTwoPi), turn = work.motion ? r.range(-0.3, 0.3) : 0;
    const double towards = r.range(0, kTwoPi), shift = work.motion ? 40 * work.blur * r.range(0.5, 1.5) : 0;
    const double nearer = work.motion ? depth * r.range(-0.15, 0.15) : 0;
    std::vector<std::vector<glm::vec4>> knots(work.motion ? 2 : 1);
    for (int i = 0; i < 3; ++i) {
        const double angle = theta + i * kTwoPi / 3 + r.range(-0.7, 0.7);
        const double radius = work.size * 0.577 * r.range(0.5, 1.4);
        const double w = std::max(0.5, depth * (1 + 0.7 * 0.577 * work.size / kPerNdc * normal(r)));
        for (std::size_t end = 0; end < knots.size(); ++end) {
            const double there = end == 0 ? 0 : 1, at = angle + there * turn, we = w + there * nearer;
            const double px = x + radius * std::cos(at) + there * shift * std::cos(towards),
                         py = y + radius * std::sin(at) + there * shift * std::sin(towards);
            knots[end].emplace_back(static_cast<float>(px * we), static_cast<float>(py * we), static_cast<float>(we),
                                    static_cast<float>(a + b * we));
        }
    }
    Frame frame = support::empty_frame(kSize, kSize, work.motion);
    frame.view.depth_near = kNear;
    support::set_mesh(frame, knots, {0, 1, 2});
    return frame;
}

void shuffle(Random& r, std::array<int, kSpp>& order) {
    std::iota(order.begin(), order.end(), 0);
    for (int i = kSpp - 1; i > 0; --i) std::swap(order[i], order[r.below(i + 1)]);
}

// The samples of a pixel of a cell, (x, y) counted from the cell's top left corner.
std::array<LocalSample, kSpp> pixel_samples(Random& r, int x, int y) {
    std::array<int, kSpp> lens, time;
    shuffle(r, lens);
    shuffle(r, time);
    std::array<LocalSample, kSpp> samples;
    for (int k = 0; k < kSpp; ++k) {
        const auto in_cell = [&](int cell) { return (cell + r.unit()) / 4; };
        const double sx = std::floor(in_cell(k % 4) * 256) / 256, sy = std::floor(in_cell(k / 4) * 256) / 256;
        const double p = 2 * in_cell(lens[k] % 4) - 1, q = 2 * in_cell(lens[k] / 4) - 1;
        const bool wide = std::abs(p) > std::abs(q);
        const double radius = wide ? p : q;
        const double angle = wide ? std::numbers::pi / 4 * (q / p)
                                  : std::numbers::pi / 2 - (q == 0 ? 0 : std::numbers::pi / 4 * (p / q));
        samples[k] = {static_cast<float>(x + sx - 16), static_cast<float>(16 - y - sy),
                      static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)),
                      static_cast<float>(std::floor((time[k] + r.unit()) / kSpp * 0x1p24) * 0x1p-24)};
    }
    return samples;
}

struct Step {
    CullStep what;
    CullSetup setup;
    CullState state;
};

// A row of the table for one triangle: which samples of a tile it would test.
class Tested {
  public:
    explicit Tested(const Row& row) : of_one_side_(row.of_one_side) {
        for (const CullStep& step : parse_culling(row.culling)) steps_.push_back({step, {}, {}});
        for (Step& step : steps_) step.state.setup = &step.setup;
    }
    Tested(Tested&& other) noexcept : steps_(std::move(other.steps_)), of_one_side_(other.of_one_side_) {
        for (Step& step : steps_) step.state.setup = &step.setup;
    }

    void begin(const LocalTriangle& T, const Footprint& picture) {
        keeps_cell_ = true;
        asked_ = !of_one_side_ || facing(T, segment_domain(T, picture.domain)) != Facing::kMixed;
        for (Step& step : steps_)
            if (step.what.test->begin != nullptr && !step.what.test->begin(T, picture, step.setup)) keeps_cell_ = false;
    }
    bool keeps(Grain grain, const LocalTriangle& T, const Footprint& footprint) {
        if (!asked_) return true;
        if (!keeps_cell_) return false;
        for (Step& step : steps_)
            if (step.what.grain == grain && !step.what.test->prepare(T, footprint, step.state)) return false;
        return true;
    }
    bool keeps(const LocalSample& sample) const {
        return !asked_ || std::all_of(steps_.begin(), steps_.end(),
                                      [&](const Step& step) { return step.what.test->keeps(step.state, sample); });
    }

  private:
    std::vector<Step> steps_;
    bool of_one_side_, asked_ = false, keeps_cell_ = false;
};

struct Counts {
    std::int64_t covered = 0, lost = 0;
    std::array<std::int64_t, kRowCount> tested{};
    void add(const Counts& other) {
        covered += other.covered;
        lost += other.lost;
        for (std::size_t k = 0; k < kRowCount; ++k) tested[k] += other.tested[k];
    }
};

// A part of the tiles of a triangle speaks for all of them: neighbours would say nearly the same.
double speaking(const Workload& work) {
    return work.size > 20 || work.blur > 1 ? 0.06 : work.size > 10 ? 0.15 : 0.25;
}

Counts count(Random& r, const Workload& work) {
    Counts counts;
    const Frame frame = random_triangle(r, work);
    const PixelRect all{0, kSize, 0, kSize};
    const PixelRect rect = covered_pixels(screen_bounds(moving_triangle(frame, 0, 0), kNear, 1), kSize, kSize, all);
    static thread_local std::vector<Tested> rows;
    if (rows.empty())
        for (const Row& row : kRows) rows.emplace_back(row);
    const Domain whole{-1, 1, -1, 1, 0, 1};
    for (int cy = rect.y0 / kCellSize; cy * kCellSize < rect.y1; ++cy)
        for (int cx = rect.x0 / kCellSize; cx * kCellSize < rect.x1; ++cx) {
            const CellCentre centre = cell_centre(frame.view, cx, cy);
            const LocalTriangle T = localize(frame, 0, 0, centre);
            const float half = kSize / 2;
            bool begun = false;
            for (int ty = 0; ty < kCellSize; ty += kCullTileSize)
                for (int tx = 0; tx < kCellSize; tx += kCullTileSize) {
                    const int left = cx * kCellSize, top = cy * kCellSize;
                    const PixelRect in{std::max(rect.x0 - left, tx), std::min(rect.x1 - left, tx + kCullTileSize),
                                       std::max(rect.y0 - top, ty), std::min(rect.y1 - top, ty + kCullTileSize)};
                    if (in.empty() || !r.chance(speaking(work))) continue;
                    if (!begun)
                        for (Tested& row : rows)
                            row.begin(T, {-half - centre.x, half - centre.x, -half - centre.y, half - centre.y, whole});
                    begun = true;
                    const auto square = [&](int x, int y, int size) {
                        const float fx = static_cast<float>(x - 16), fy = static_cast<float>(16 - y),
                                    side = static_cast<float>(size);
                        return Footprint{fx, fx + side, fy - side, fy, whole};
                    };
                    std::array<bool, kRowCount> tile{};
                    for (std::size_t k = 0; k < kRowCount; ++k)
                        tile[k] = rows[k].keeps(Grain::kTile, T, square(tx, ty, kCullTileSize));
                    for (int y = in.y0; y < in.y1; ++y)
                        for (int x = in.x0; x < in.x1; ++x) {
                            const auto samples = pixel_samples(r, x, y);
                            std::uint32_t covered = 0;
                            for (int i = 0; i < kSpp; ++i)
                                covered |= std::uint32_t{cover_sample(T, samples[i], centre).hit} << i;
                            counts.covered += std::popcount(covered);
                            for (std::size_t k = 0; k < kRowCount; ++k) {
                                std::uint32_t kept = 0;
                                if (tile[k] && rows[k].keeps(Grain::kPixel, T, square(x, y, 1)))
                                    for (int i = 0; i < kSpp; ++i)
                                        kept |= std::uint32_t{rows[k].keeps(samples[i])} << i;
                                counts.tested[k] += std::popcount(kept);
                                counts.lost += std::popcount(covered & ~kept);
                            }
                        }
                }
        }
    return counts;
}

class CullingEfficiency : public ::testing::TestWithParam<std::size_t> {};

TEST_P(CullingEfficiency, IsWhatIsKnownOfEachTest) {
    const Workload& work = kWorkloads[GetParam()];
    const int triangles = 300 * support::effort();
    std::vector<Counts> counts(triangles);
    tbb::parallel_for(0, triangles, [&](int i) {
        Random r(1'000'003u * (GetParam() + 1) + i);
        counts[i] = count(r, work);
    });
    Counts total;
    for (const Counts& c : counts) total.add(c);
    EXPECT_EQ(total.lost, 0);
    for (std::size_t k = 0; k < kRowCount; ++k) {
        const double expected = kRows[k].efficiency[GetParam()];
        const double actual = 100.0 * static_cast<double>(total.covered) / static_cast<double>(total.tested[k]);
        std::printf("%-46s %-16s %6.2f, known %6.2f (%+.1f %%)\n", kRows[k].culling, work.name, actual, expected,
                    100 * (actual / expected - 1));
        if (expected < 2.0) continue;
        EXPECT_GE(actual, 0.9 * expected) << kRows[k].culling << ", " << work.name;
        EXPECT_LE(actual, 1.1 * expected) << kRows[k].culling << ", " << work.name;
    }
}

INSTANTIATE_TEST_SUITE_P(Statistic, CullingEfficiency, ::testing::Range(std::size_t{0}, kColumns),
                         [](const auto& info) {
                             std::string name = kWorkloads[info.param].name;
                             for (char& c : name)
                                 if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
                             return name;
                         });

}  // namespace
}  // namespace pentaprism
