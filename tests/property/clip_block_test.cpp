// Posing by vectors: each kernel against the plain arithmetic it stands for, bit for bit, on every CPU target.
#include "frame/clip_block.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "support/isa.h"

namespace pentaprism {
namespace {

constexpr std::size_t kSize = PointBlock::kSize;

class ClipBlocks : public testing::TestWithParam<const char*> {
  protected:
    ClipBlocks() : isa_(GetParam()) {}
    double number(double reach) { return std::uniform_real_distribution<double>(-reach, reach)(random_); }
    glm::dmat4 matrix() {
        glm::dmat4 m(1.0);
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 3; ++row) m[column][row] = number(3.0);
        return m;
    }
    PointBlock points() {
        PointBlock p;
        for (std::size_t i = 0; i < kSize; ++i) p.x[i] = number(10.0), p.y[i] = number(10.0), p.z[i] = number(10.0);
        return p;
    }
    View view() {
        View v;
        v.width = 640, v.height = 480;
        v.fx = 700.0 + number(100.0), v.fy = 600.0 + number(100.0);
        v.lens.radius = 0.02, v.lens.focus_distance = 5.0;
        v.lens.focus(v.fx);
        return v;
    }
    const support::UseIsa isa_;
    std::mt19937_64 random_{7};
};

TEST_P(ClipBlocks, TransformsAsAMatrixDoes) {
    const ClipKernels kernels = clip_kernels();
    for (int round = 0; round < 50; ++round) {
        const glm::dmat4 m = matrix();
        const PointBlock p = points();
        PointBlock moved;
        kernels.transform(m, p, moved);
        for (std::size_t i = 0; i < kSize; ++i) {
            const glm::dvec3 q = Affine(m).point({p.x[i], p.y[i], p.z[i]});
            ASSERT_EQ(moved.x[i], q.x);
            ASSERT_EQ(moved.y[i], q.y);
            ASSERT_EQ(moved.z[i], q.z);
        }
    }
}

TEST_P(ClipBlocks, ProjectsAsTheViewDoes) {
    const ClipKernels kernels = clip_kernels();
    for (int round = 0; round < 60; ++round) {
        View v = view();
        v.perspective = round % 3 != 0;
        if (round % 4 == 1) v.lens.tilt = {0.2, -0.1};
        if (round % 4 == 2) v.lens.sharp_range = {2.0, 6.0};
        const glm::dmat4 to_camera = matrix();
        const PointBlock world = points();
        ClipBlock clip;
        kernels.to_clip(v, to_camera, world, clip);
        for (std::size_t i = 0; i < kSize; ++i) {
            const glm::dvec4 p =
                to_raster_clip(v, glm::dvec3(to_camera * glm::dvec4(world.x[i], world.y[i], world.z[i], 1.0)));
            ASSERT_EQ(clip.x[i], p.x);
            ASSERT_EQ(clip.y[i], p.y);
            ASSERT_EQ(clip.w[i], p.z);
            ASSERT_EQ(clip.z[i], p.w);
            ASSERT_EQ(clip.c[i], v.coc(p.x, p.y, p.w));
        }
    }
}

TEST_P(ClipBlocks, FindsTheWorstErrorOfAPath) {
    const ClipKernels kernels = clip_kernels();
    for (int round = 0; round < 100; ++round) {
        View v = view();
        v.optics_move = round % 2 != 0;  // radii count, too
        const glm::dmat4 m[3] = {matrix(), matrix(), matrix()};
        const PointBlock world = points();
        ClipBlock p, q, truth;
        kernels.to_clip(v, m[0], world, p);
        kernels.to_clip(v, m[1], world, q);
        kernels.to_clip(v, m[2], world, truth);
        if (round % 5 == 0) truth.x[round] = NAN;  // counts for nothing
        const double s = 0.25 * (1 + round % 3);
        double worst = 0.0;
        for (std::size_t i = 0; i < kSize; ++i) {
            const auto straight = [&](const double* a, const double* b) { return a[i] + s * (b[i] - a[i]); };
            const double w = straight(p.w, q.w), x = truth.x[i] / truth.w[i], y = truth.y[i] / truth.w[i];
            if (!(w >= v.w_near() && truth.w[i] >= v.w_near() && std::abs(x) < 1280.0 && std::abs(y) < 1280.0))
                continue;
            const double dx = straight(p.x, q.x) / w - x, dy = straight(p.y, q.y) / w - y;
            worst = std::max(worst, dx * dx + dy * dy);
            const double dr = straight(p.c, q.c) / w - truth.c[i] / truth.w[i];
            if (v.optics_move) worst = std::max(worst, dr * dr);
        }
        ASSERT_EQ(kernels.path_error(v, p, q, truth, s), std::sqrt(worst));
    }
}

TEST_P(ClipBlocks, SeesEveryDifference) {
    const ClipKernels kernels = clip_kernels();
    const View v = view();
    ClipBlock a;
    kernels.to_clip(v, matrix(), points(), a);
    EXPECT_TRUE(kernels.is_equal(a, a));
    for (double* values : {a.x, a.y, a.w, a.z, a.c})
        for (std::size_t i = 0; i < kSize; i += 13) {
            const ClipBlock before = a;
            const double old = values[i];
            values[i] = std::nextafter(old, 1e30);
            EXPECT_FALSE(kernels.is_equal(a, before));
            values[i] = old;
        }
}

std::vector<const char*> targets() {
    std::vector<const char*> here;
    for (const char* name : {"scalar", "avx2", "avx512", "neon"})
        if (support::has_isa(name)) here.push_back(name);
    return here;
}
INSTANTIATE_TEST_SUITE_P(Targets, ClipBlocks, testing::ValuesIn(targets()));

}  // namespace
}  // namespace pentaprism
