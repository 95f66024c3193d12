// Neighbours share every edge and vertex without gap and without double hit, under motion and defocus, with the
// compiler flags that ship (docs/develop/algorithms.md 2.3).
#include <gtest/gtest.h>

#include "cover/exact.h"
#include "support/random.h"
#include "support/visible.h"

namespace pentaprism {
namespace {

using support::effort;
using support::Random;
using support::Visible;

constexpr int kSide = 7;  // cells a side of the mesh

struct Mesh {
    Frame frame;
    std::vector<LocalTriangle> triangles;  // as the cell of the test sees them
    CellCentre centre{};
    int segment = 0;
};

struct Deform {
    double jitter;  // of vertices, in mesh cells
    bool integers;  // exact ties
};

// A sheet that moves and is out of focus as a whole, with vertices that also move on their own but never fold it.
Mesh make_mesh(Random& r, const Deform& deform, int segments) {
    Mesh mesh;
    mesh.frame = support::empty_frame(deform.integers ? 64 : r.between(40, 3000),
                                      deform.integers ? 64 : r.between(40, 3000), true, segments);
    mesh.frame.view.lens.ratio = deform.integers ? 1.0 : r.range(0.5, 2);
    mesh.segment = r.below(segments);
    mesh.centre = cell_centre(mesh.frame.view, r.below(mesh.frame.view.width / kCellSize + 1),
                              r.below(mesh.frame.view.height / kCellSize + 1));
    const double pitch = deform.integers ? 2 : r.magnitude(0.3, 6), angle = deform.integers ? 0 : r.range(0, 6.28);
    const double w0 = deform.integers ? 1 : r.range(0.5, 9), blur = deform.integers ? 2 : r.range(-20, 20);
    const double mx = deform.integers ? r.between(-4, 4) : r.range(-30, 30),
                 my = deform.integers ? r.between(-4, 4) : r.range(-30, 30);
    std::vector<std::vector<glm::vec4>> knots(segments + 1);
    for (int knot = 0; knot <= segments; ++knot)
        for (int j = 0; j <= kSide; ++j)
            for (int i = 0; i <= kSide; ++i) {
                const double a = pitch * (i - 0.5 * kSide + r.range(-1, 1) * deform.jitter),
                             b = pitch * (j - 0.5 * kSide + r.range(-1, 1) * deform.jitter);
                const double x = std::cos(angle) * a - std::sin(angle) * b + (knot - mesh.segment) * mx;
                const double y = std::sin(angle) * a + std::cos(angle) * b + (knot - mesh.segment) * my;
                const double w = w0 * (1 + 0.0017 * pitch * r.range(-1, 1) * (deform.jitter > 0));
                const double c = blur * w * (1 + 0.02 * deform.jitter * r.unit() * pitch);
                knots[knot].emplace_back(static_cast<float>(w * x + mesh.centre.x * w),
                                         static_cast<float>(w * y + mesh.centre.y * w), static_cast<float>(w),
                                         static_cast<float>(c));
            }
    std::vector<std::uint32_t> corners;
    for (std::uint32_t j = 0; j < kSide; ++j)
        for (std::uint32_t i = 0; i < kSide; ++i) {
            const std::uint32_t a = j * (kSide + 1) + i, b = a + 1, c = a + kSide + 1, d = c + 1;
            if (r.chance(0.5))
                corners.insert(corners.end(), {a, b, d, a, d, c});
            else
                corners.insert(corners.end(), {a, b, c, c, b, d});
        }
    support::set_mesh(mesh.frame, knots, corners);
    for (std::uint32_t t = 0; t < mesh.frame.triangle_count(); ++t)
        mesh.triangles.push_back(localize(mesh.frame, t, mesh.segment, mesh.centre));
    return mesh;
}

// A sample on a corner, on an edge or inside of a triangle away from the sheet's border.
bool aim(Random& r, const Mesh& mesh, const Deform& deform, LocalSample& sample) {
    const int cell = r.between(2, kSide - 3) * kSide + r.between(2, kSide - 3);
    const LocalTriangle& T = mesh.triangles[2 * static_cast<std::size_t>(cell) + r.below(2)];
    double a[3] = {r.unit(), r.unit(), r.unit()};
    const int zeros = r.below(3), first = r.below(3);
    for (int k = 0; k < zeros; ++k) a[(first + k) % 3] = 0;
    if (deform.integers)
        for (double& weight : a) weight = weight > 0 ? 1 : 0;
    const double sum = a[0] + a[1] + a[2];
    const double tau0 = deform.integers ? r.below(4) * 0.25 : r.range(0, 0.999);
    sample.t = static_cast<float>(std::ceil((tau0 + T.segment) / T.segments * 16777216.0) / 16777216.0);
    sample.u = static_cast<float>(deform.integers ? r.between(-2, 2) * 0.5 : r.range(-1, 1));
    sample.v = static_cast<float>(deform.integers ? r.between(-2, 2) * 0.5 : r.range(-1, 1));
    const double tau = static_cast<double>(sample.t) * T.segments - T.segment;
    double x = 0, y = 0, w = 0;
    for (int i = 0; i < 3; ++i) {
        const double c = T.qc[i] + tau * T.dc[i];
        x += a[i] / sum * (T.qx[i] + tau * T.dx[i] + sample.u * c);
        y += a[i] / sum * (T.qy[i] + tau * T.dy[i] + sample.v * c);
        w += a[i] / sum * (T.qw[i] + tau * T.dw[i]);
    }
    sample.hx = static_cast<float>(x / w);
    sample.hy = static_cast<float>(y / w);
    return std::abs(sample.hx) < 16 && std::abs(sample.hy) < 16;
}

struct Counts {
    int samples = 0, gaps = 0, doubles = 0, ties = 0;
};

bool is_tied(const LocalTriangle& T, const LocalSample& s) {
    const SampleHit hit = project_sample(T, s);
    return hit.barycentrics[0] == 0 || hit.barycentrics[1] == 0 || hit.barycentrics[2] == 0;
}

Counts count(std::uint64_t seed, const Deform& deform, int meshes) {
    Random r(seed);
    Counts counts;
    for (int m = 0; m < meshes; ++m) {
        const Mesh mesh = make_mesh(r, deform, r.between(1, 4));
        for (int k = 0; k < 100; ++k) {
            LocalSample sample;
            if (!aim(r, mesh, deform, sample)) continue;
            int hits = 0;
            bool tied = false;
            for (const LocalTriangle& T : mesh.triangles) {
                const bool hit = cover_sample(T, sample, mesh.centre).hit;
                hits += hit;
                tied = tied || (hit && is_tied(T, sample));
            }
            ++counts.samples;
            counts.gaps += hits == 0;
            counts.doubles += hits > 1;
            counts.ties += tied;
        }
    }
    return counts;
}

TEST(Watertight, RegularMeshesInMotionAndOutOfFocusAreHitOnce) {
    const Counts counts = count(41, {0.0, false}, 1500 * effort());
    EXPECT_GT(counts.samples, 50'000);
    EXPECT_EQ(counts.gaps, 0);
    EXPECT_EQ(counts.doubles, 0);
}

TEST(Watertight, JitteredMeshesWithVerticesOnPathsOfTheirOwnAreHitOnce) {
    const Counts counts = count(42, {0.15, false}, 1500 * effort());
    EXPECT_GT(counts.samples, 50'000);
    EXPECT_EQ(counts.gaps, 0);
    EXPECT_EQ(counts.doubles, 0);
}

TEST(Watertight, SamplesExactlyOnEdgesAndVerticesAreHitOnce) {
    const Counts counts = count(43, {0.0, true}, 1500 * effort());
    EXPECT_GT(counts.ties, 20'000) << "the test is about ties";
    EXPECT_EQ(counts.gaps, 0);
    EXPECT_EQ(counts.doubles, 0);
}

// ---- A plain 2D rasterizer
// ---------------------------------------------------------------------------------------------

struct Point2 {
    std::int64_t x, y;  // in 1/256 pixel, y up
};

// Inside, with the sample at (x + h, y + h^2) for a vanishing h: to the left of all edges, or on one of them that is on
// the sample's far side.
bool covers(const Point2 p[3], std::int64_t x, std::int64_t y) {
    int side = 0;
    for (int k = 0; k < 3; ++k) {
        const Point2 a = p[k], b = p[(k + 1) % 3];
        const std::int64_t e = (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
        const std::int64_t by_x = -(b.y - a.y), by_y = b.x - a.x;
        const std::int64_t s = e != 0 ? e : by_x != 0 ? by_x : by_y;
        const int sign = s > 0 ? 1 : s < 0 ? -1 : 0;
        if (sign == 0 || (side != 0 && sign != side)) return false;
        side = sign;
    }
    return true;
}

TEST(StaticPinhole, EqualsAPlainTwoDimensionalRasterizer) {
    Random r(44);
    constexpr int kWidth = 70, kHeight = 50;
    const SampleTable samples(8, 1, Lens{}, Grouping::kStill);
    std::int64_t hits = 0;
    for (int picture = 0; picture < 20; ++picture) {
        Frame frame = support::empty_frame(kWidth, kHeight, false);
        std::vector<glm::vec4> points;
        std::vector<Point2> exact;
        std::vector<std::uint32_t> corners;
        for (std::uint32_t t = 0; t < 60; ++t) {
            const int x0 = r.between(-40 * 16, 40 * 16), y0 = r.between(-30 * 16, 30 * 16),
                      grid = r.chance(0.5) ? 16 : 1;
            for (std::uint32_t k = 0; k < 3;
                 ++k) {  // on a grid of 1/16 pixel or whole pixels: edge functions are exact
                const int x = (x0 + r.below(12 * 16)) / grid * grid, y = (y0 + r.below(12 * 16)) / grid * grid;
                points.emplace_back(static_cast<float>(x) / 16, static_cast<float>(y) / 16, 1.0f, 0.0f);
                exact.push_back({x * 16, y * 16});
                corners.push_back(3 * t + k);
            }
        }
        support::set_mesh(frame, {points}, corners);
        const Visible visible(frame, samples);
        for (int py = 0; py < kHeight; ++py)
            for (int px = 0; px < kWidth; ++px)
                for (int i = 0; i < samples.spp(); ++i) {
                    const SamplePoint s = samples.sample(px, py, i);
                    const std::int64_t x = px * 256 + std::lround(s.x * 256) - kWidth * 128,
                                       y = kHeight * 128 - py * 256 - std::lround(s.y * 256);
                    std::uint32_t expected = kNoTriangle;
                    for (std::uint32_t t = 0; t < 60 && expected == kNoTriangle; ++t)
                        if (covers(&exact[3 * t], x, y)) expected = t;
                    hits += expected != kNoTriangle;
                    ASSERT_EQ(visible.at(px, py, i).triangle, expected)
                        << "pixel " << px << ", " << py << ", sample " << i;
                }
    }
    EXPECT_GT(hits, 50'000);
}

}  // namespace
}  // namespace pentaprism
