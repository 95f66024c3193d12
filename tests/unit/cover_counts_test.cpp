// What the scalar walker says a tile cost: by counter, and by pixel.
#include <gtest/gtest.h>
#include <numeric>

#include "render/visibility.h"
#include "support/soup.h"
#include "support/visible.h"

namespace pentaprism {
namespace {

TEST(CoverCounts, AreTheSumsOfTheirMapAndNest) {
    support::Random r(41);
    support::Soup soup;
    const Frame frame = make_soup(r, soup);
    const SampleTable samples(8, 3, frame.view.lens, Grouping::kBoth);
    for (const char* culling : {"none", "improved-dual-space"}) {
        MethodSettings method;
        method.culling = culling;
        const Visibility visibility(frame, samples, method, {0, soup.width, 0, soup.height});
        CoverMap map{soup.width, soup.height, {}, {}};
        map.tested.resize(static_cast<std::size_t>(soup.width) * soup.height);
        map.covered.resize(map.tested.size());
        CoverCounts counts;
        Hits hits;
        for (const Tile& tile : visibility.tiles()) visibility.cover(tile, hits, counts, &map);
        EXPECT_EQ(counts.tested, std::accumulate(map.tested.begin(), map.tested.end(), std::int64_t{0}));
        EXPECT_EQ(counts.covered, std::accumulate(map.covered.begin(), map.covered.end(), std::int64_t{0}));
        EXPECT_GT(counts.covered, 0);
        EXPECT_LE(counts.covered, counts.tested);
        EXPECT_LE(counts.tested, counts.asked);
        EXPECT_LE(counts.kept_footprints, counts.footprints);
        EXPECT_LE(counts.asked, counts.kept_footprints * samples.spp());
        if (std::string(culling) == "none") {
            EXPECT_EQ(counts.tested, counts.asked);
            EXPECT_EQ(counts.kept_footprints, counts.footprints);
        }
    }
}

// A wall and a crowd of triangles behind it, which moves: where the wall stands, `hierarchical` asks about none of
// them.
class Hidden : public ::testing::Test {
  protected:
    static Frame scene(bool wall_leaves) {
        Frame frame = support::empty_frame(64, 64, true);
        support::Random r(5);
        std::vector<std::vector<glm::vec4>> knots(2);
        std::vector<std::uint32_t> corners;
        const auto add = [&](float x, float y, float size, float w, float shift) {
            for (int i = 0; i < 3; ++i) {
                const glm::vec2 corner[] = {{-1, -1}, {3, -1}, {-1, 3}};
                for (int end = 0; end < 2; ++end)
                    knots[end].emplace_back((x + size * corner[i].x + static_cast<float>(end) * shift) * w,
                                            (y + size * corner[i].y) * w, w, 0.0f);
                corners.push_back(static_cast<std::uint32_t>(corners.size()));
            }
        };
        for (int i = 0; i < 200; ++i)
            add(static_cast<float>(r.range(-30, 30)), static_cast<float>(r.range(-30, 30)), 3, 20, 6);
        add(0, 0, 64, 2, wall_leaves ? 400 : 0);  // drawn last, seen first
        support::set_mesh(frame, knots, corners);
        return frame;
    }
    static CoverCounts counts(const Frame& frame, const char* culling) {
        const SampleTable samples(16, 3, frame.view.lens, Grouping::kMotion);
        MethodSettings method;
        method.culling = culling;
        const Visibility visibility(frame, samples, method, {0, 64, 0, 64});
        CoverCounts counts;
        Hits hits;
        for (const Tile& tile : visibility.tiles()) visibility.cover(tile, hits, counts);
        return counts;
    }
};

TEST_F(Hidden, TrianglesAreNotTestedByHierarchical) {
    const Frame frame = scene(false);
    const std::int64_t wall = 64 * 64 * 16;
    EXPECT_GT(counts(frame, "improved-dual-space").covered, wall + 10000);
    EXPECT_EQ(counts(frame, "hierarchical").covered, wall);
}

TEST_F(Hidden, TrianglesAreTestedWhenWhatHidesThemIsGone) {
    // The wall is gone after the first sixth of the shutter: most of what it hides is seen.
    const Frame frame = scene(true);
    const CoverCounts all = counts(frame, "improved-dual-space"), few = counts(frame, "hierarchical");
    EXPECT_GT(few.covered, all.covered / 2);
    EXPECT_LE(few.covered, all.covered);
}

}  // namespace
}  // namespace pentaprism
