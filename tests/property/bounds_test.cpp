// Screen bounds, facing and bins lose no sample that the exact test accepts (docs/develop/algorithms.md 3.2, 3.6).
#include <gtest/gtest.h>
#include <set>
#include <utility>

#include "bin/bins.h"
#include "bound/facing.h"
#include "bound/screen_bounds.h"
#include "support/soup.h"

namespace pentaprism {
namespace {

using support::effort;
using support::for_each_accepted;
using support::Hard;
using support::HardCase;
using support::kHardClasses;
using support::LensShape;
using support::name_of;
using support::Random;

class EveryHardTriangle : public ::testing::TestWithParam<Hard> {};

TEST_P(EveryHardTriangle, IsSeenOnlyInsideItsScreenBounds) {
    int lost = 0, in_front_of_nearest = 0;
    const int wanted = 50'000 * effort();
    const int accepted = for_each_accepted(
        GetParam(), 11, wanted, LensShape::kSquare, true,
        [&](const HardCase& c, const LocalSample& s, const SampleHit& hit) {
            const ScreenBox box = screen_bounds(c.moving, c.frame.view.w_near(), c.frame.view.lens.ratio);
            const double gx = static_cast<double>(c.centre.x) + s.hx, gy = static_cast<double>(c.centre.y) + s.hy;
            if (!(gx >= box.x0 && gx <= box.x1 && gy >= box.y0 && gy <= box.y1)) ++lost;
            if (hit.depth < box.nearest_w * (1 - 16 * 0x1p-24)) ++in_front_of_nearest;
        });
    EXPECT_GE(accepted, wanted);
    EXPECT_EQ(lost, 0);
    EXPECT_EQ(in_front_of_nearest, 0);
}

TEST_P(EveryHardTriangle, IsListedByBinsForThePixelsThatSeeIt) {
    int lost = 0;
    for_each_accepted(
        GetParam(), 12, 5'000 * effort(), LensShape::kSquare, true,
        [&](const HardCase& c, const LocalSample& s, const SampleHit&) {
            const int px = c.cx * kCellSize + static_cast<int>(std::floor(s.hx + 16)),
                      py = c.cy * kCellSize + static_cast<int>(std::floor(16 - s.hy));
            const View& view = c.frame.view;
            if (px >= view.width || py >= view.height) return;
            const ScreenBox box = screen_bounds(c.moving, view.w_near(), view.lens.ratio);
            const PixelRect rect = covered_pixels(box, view.width, view.height, {0, view.width, 0, view.height});
            if (!(px >= rect.x0 && px < rect.x1 && py >= rect.y0 && py < rect.y1)) ++lost;
        });
    EXPECT_EQ(lost, 0);
}

TEST_P(EveryHardTriangle, ShowsOnlyTheSideThatFacingPromises) {
    int wrong = 0, decided = 0;
    for_each_accepted(GetParam(), 13, 50'000 * effort(), LensShape::kDisk, true,
                      [&](const HardCase& c, const LocalSample&, const SampleHit& hit) {
                          const Facing side = facing(c.moving, c.frame.view.lens.ratio);
                          decided += side != Facing::kMixed;
                          wrong += side == (hit.front ? Facing::kBack : Facing::kFront);
                      });
    EXPECT_EQ(wrong, 0);
    if (GetParam() == Hard::kGeneric || GetParam() == Hard::kStatic) {
        EXPECT_GT(decided, 1000) << "a promise that is never made proves nothing";
    }
}

INSTANTIATE_TEST_SUITE_P(Bounds, EveryHardTriangle, ::testing::ValuesIn(kHardClasses), [](const auto& info) {
    std::string name = name_of(info.param);
    for (char& ch : name)
        if (std::isalnum(static_cast<unsigned char>(ch)) == 0) ch = '_';
    return name;
});

// Wu's variant: three edges at each end and three vertex paths, without the six diagonals of the swept patches.
bool nine_edge_box_holds(const MovingTriangle& m, double near, double gx, double gy) {
    double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
    auto add = [&](double x, double y, double w, double c) {
        x0 = std::min(x0, (x - std::abs(c)) / w), x1 = std::max(x1, (x + std::abs(c)) / w);
        y0 = std::min(y0, (y - std::abs(c)) / w), y1 = std::max(y1, (y + std::abs(c)) / w);
    };
    for (int a = 0; a < 6; ++a) {
        const int i = a / 2, e = a % 2;
        if (m.w[i][e] >= near) add(m.x[i][e], m.y[i][e], m.w[i][e], m.c[i][e]);
        for (int b = a + 1; b < 6; ++b) {
            const int j = b / 2, f = b % 2;
            if ((i != j && e != f) || (m.w[i][e] >= near) == (m.w[j][f] >= near)) continue;
            const double s = (near - m.w[i][e]) / (m.w[j][f] - m.w[i][e]);
            add(m.x[i][e] + s * (m.x[j][f] - m.x[i][e]), m.y[i][e] + s * (m.y[j][f] - m.y[i][e]), near,
                m.c[i][e] + s * (m.c[j][f] - m.c[i][e]));
        }
    }
    const double slack = 1e-3 + 1e-4 * std::max(std::abs(gx), std::abs(gy));
    return gx >= x0 - slack && gx <= x1 + slack && gy >= y0 - slack && gy <= y1 + slack;
}

TEST(NineOfTheFifteenEdges, AreNotEnoughAndThatIsCaught) {
    int lost = 0;
    for (const Hard hard : {Hard::kStraddling, Hard::kNearZero, Hard::kLattice})
        for_each_accepted(
            hard, 14, 100'000, LensShape::kDisk, true, [&](const HardCase& c, const LocalSample& s, const SampleHit&) {
                if (c.frame.view.lens.ratio != 1.0) return;
                lost += !nine_edge_box_holds(c.moving, c.frame.view.w_near(), static_cast<double>(c.centre.x) + s.hx,
                                             static_cast<double>(c.centre.y) + s.hy);
            });
    EXPECT_GT(lost, 0);
}

TEST(Facing, IsNotDecidedByTheTwoEndsOfTheShutter) {
    // Back-facing at both ends, front-facing for t in (1/4, 3/4): D(t) = (1 - 4t/3)(4t - 1).
    MovingTriangle m{};
    const float x[3][2] = {{0, 0}, {1, -1.0f / 3}, {0, 0}}, y[3][2] = {{0, 0}, {0, 0}, {-1, 3}};
    for (int i = 0; i < 3; ++i)
        for (int e = 0; e < 2; ++e) m.x[i][e] = x[i][e], m.y[i][e] = y[i][e], m.w[i][e] = m.z[i][e] = 1;
    EXPECT_EQ(facing(m, 1.0), Facing::kMixed);
    for (int i = 0; i < 3; ++i) m.x[i][1] = m.x[i][0], m.y[i][1] = m.y[i][0];
    EXPECT_EQ(facing(m, 1.0), Facing::kBack);
    std::swap(m.x[1], m.x[2]);
    std::swap(m.y[1], m.y[2]);
    EXPECT_EQ(facing(m, 1.0), Facing::kFront);
}

TEST(Bins, ListEverySegmentInEveryTileOfItsRectangleOnceAndInOrder) {
    Random r(15);
    for (int i = 0; i < 12; ++i) {
        support::Soup soup;
        soup.width = r.between(1, 150);
        soup.height = r.between(1, 150);
        soup.single_sided = i % 3 == 0;
        const Frame frame = make_soup(r, soup);
        for (const int size : {8, 16, 32}) {
            const PixelRect limits{r.below(soup.width), soup.width, r.below(soup.height), soup.height};
            const Bins bins(frame, size, limits);
            const auto triangles = bins.triangles();
            for (int y = limits.y0 / size * size; y < limits.y1; y += size)
                for (int x = limits.x0 / size * size; x < limits.x1; x += size) {
                    std::vector<std::uint32_t> expected;
                    for (std::uint32_t k = 0; k < triangles.size(); ++k) {
                        const BinnedTriangle& b = triangles[k];
                        if (b.x0 < x + size && b.x1 > x && b.y0 < y + size && b.y1 > y) expected.push_back(k);
                    }
                    const auto listed = bins.tile(x, y);
                    ASSERT_EQ(std::vector<std::uint32_t>(listed.begin(), listed.end()), expected);
                }
            for (std::size_t k = 1; k < triangles.size(); ++k)
                ASSERT_LT(std::pair(triangles[k - 1].triangle, triangles[k - 1].segment),
                          std::pair(triangles[k].triangle, triangles[k].segment));
        }
    }
}

TEST(Bins, DropWhatIsNotFiniteOrTooLarge) {
    for (const float bad : {INFINITY, -INFINITY, NAN, 2e12f}) {
        Random r(16);
        support::Soup soup;
        soup.classes = {Hard::kGeneric};
        soup.motion = false;
        soup.triangles = 1;
        Frame frame = make_soup(r, soup);
        frame.points[1].x = bad;
        EXPECT_TRUE(Bins(frame, 32, {0, soup.width, 0, soup.height}).triangles().empty()) << bad;
    }
}

}  // namespace
}  // namespace pentaprism
