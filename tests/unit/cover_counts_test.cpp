// What the scalar walker says a tile cost: by counter, and by pixel.
#include <gtest/gtest.h>
#include <numeric>

#include "render/visibility.h"
#include "support/soup.h"

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

}  // namespace
}  // namespace pentaprism
