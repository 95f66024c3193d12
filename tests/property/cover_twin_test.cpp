// The vector kernels of every CPU target, those for samples that share lens position and time, and the scalar path with
// and without culling, give the same depths and triangles bit for bit.
#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <utility>

#include "cover/front_to_back.h"
#include "cover/wide_blur.h"
#include "render/visibility.h"
#include "support/isa.h"
#include "support/soup.h"

namespace pentaprism {
namespace {

using support::effort;
using support::Hard;
using support::has_isa;
using support::make_soup;
using support::Random;
using support::Soup;
using support::UseIsa;

const SampleTable& table(int spp, Grouping grouping, double ratio, SamplePattern pattern = SamplePattern::kFree) {
    static std::map<std::tuple<int, Grouping, double, SamplePattern>, SampleTable> tables;
    const auto key = std::tuple(spp, grouping, ratio, pattern);
    auto found = tables.find(key);
    if (found == tables.end()) {
        Lens lens;
        lens.ratio = ratio;
        found = tables.emplace(key, SampleTable(spp, 7, lens, grouping, pattern)).first;
    }
    return found->second;
}

std::size_t covered(const Hits& hits) {
    return hits.triangle.size() -
           static_cast<std::size_t>(std::count(hits.triangle.begin(), hits.triangle.end(), kNoTriangle));
}

// Compares the pixels within the limits. Returns the number of samples that hit something.
std::size_t expect_twins(const Frame& frame, const SampleTable& samples, int tile_size, const PixelRect& limits) {
    MethodSettings method;
    method.tile_size = tile_size;
    const Visibility fast(frame, samples, method, limits);
    method.culling = "none";
    const Visibility plain(frame, samples, method, limits);
    method.culling = "improved-dual-space";
    const Visibility culled(frame, samples, method, limits);
    Hits expected, actual;
    CoverCounts counts;
    std::size_t total = 0;
    auto expect_same = [&](const Tile& tile, const char* what) {
        int different = 0;
        for (int py = std::max(tile.y0, limits.y0); py < tile.y1; ++py)
            for (int px = std::max(tile.x0, limits.x0); px < tile.x1; ++px)
                for (int index = 0; index < samples.spp(); ++index) {
                    const std::size_t s = expected.entry(px, py, samples.slot_of(px, py, index));
                    const bool same = actual.triangle[s] == expected.triangle[s] &&
                                      std::memcmp(&actual.depth[s], &expected.depth[s], 4) == 0;
                    if (!same && different++ == 0)
                        ADD_FAILURE() << what << ": pixel (" << px << ", " << py << "), sample " << index
                                      << ", tile size " << tile_size << ", spp " << samples.spp() << ", picture "
                                      << frame.view.width << "x" << frame.view.height << ": triangle "
                                      << actual.triangle[s] << " at " << actual.depth[s] << ", expected "
                                      << expected.triangle[s] << " at " << expected.depth[s];
                }
        EXPECT_EQ(different, 0) << "samples of the tile differ";
    };
    for (const Tile& tile : plain.tiles()) {
        plain.cover(tile, expected, counts);
        total += covered(expected);
        culled.cover(tile, actual, counts);
        expect_same(tile, "improved-dual-space");
        for (const char* isa : {"avx512", "avx2", "neon", "scalar"}) {
            if (!has_isa(isa)) continue;
            const UseIsa use(isa);
            fast.cover(tile, actual, counts);
            expect_same(tile, isa);
            if (limits.x0 == 0 && limits.y0 == 0) {  // lanes beyond the border, too
                EXPECT_TRUE(actual.triangle == expected.triangle && actual.depth == expected.depth)
                    << isa << ", lanes beyond the border";
            }
        }
        if (::testing::Test::HasFailure()) break;
    }
    return total;
}

struct Blur {
    const char* name;
    bool motion, defocus;
    Grouping grouping;
    SamplePattern pattern = SamplePattern::kFree;
};
void PrintTo(const Blur& blur, std::ostream* out) {
    *out << blur.name;
}
class CoverTwins : public ::testing::TestWithParam<Blur> {
  protected:
    Soup soup() const {
        Soup soup;
        soup.motion = GetParam().motion;
        soup.defocus = GetParam().defocus;
        return soup;
    }
    const SampleTable& samples(int spp, double ratio = 1.0) const {
        return table(spp, GetParam().grouping, ratio, GetParam().pattern);
    }
    // Where nothing blurs, sixteen samples per pixel take a path of their own.
    int spp(int otherwise) const {
        return GetParam().grouping == Grouping::kStill && GetParam().pattern == SamplePattern::kFree ? 16 : otherwise;
    }
    static PixelRect whole(const Soup& soup) { return {0, soup.width, 0, soup.height}; }
};

TEST_P(CoverTwins, AgreeForEverySampleCount) {
    Random r(21);
    for (const int spp : {1, 2, 3, 4, 5, 8, 13, 16, 20, 64}) {
        Soup s = soup();
        s.width = r.between(3, 70);
        s.height = r.between(3, 40);
        s.triangles = spp > 16 ? 1 : 2 * effort();
        const Frame frame = make_soup(r, s);
        EXPECT_GT(expect_twins(frame, samples(spp), 8 << r.below(3), whole(s)), 0u);
    }
}

TEST_P(CoverTwins, AgreeForEveryTileSizeAndPictureSize) {
    Random r(22);
    for (const int tile_size : {8, 16, 32})
        for (int i = 0; i < 3 * effort(); ++i) {
            Soup s = soup();
            s.width = r.between(1, 100);
            s.height = r.between(1, 50);
            s.triangles = 3;
            expect_twins(make_soup(r, s), samples(spp(4)), tile_size, whole(s));
        }
}

TEST_P(CoverTwins, AgreeBehindAndAcrossTheCameraPlane) {
    Random r(23);
    for (int i = 0; i < 6 * effort(); ++i) {
        Soup s = soup();
        s.classes = {Hard::kStraddling, Hard::kNearZero, Hard::kLattice};
        s.triangles = 5;
        EXPECT_GT(expect_twins(make_soup(r, s), samples(spp(5)), 32, whole(s)), 0u);
    }
}

TEST_P(CoverTwins, AgreeForSingleSidedTriangles) {
    Random r(24);
    for (int i = 0; i < 4 * effort(); ++i) {
        Soup s = soup();
        s.single_sided = true;
        s.triangles = 4;
        EXPECT_GT(expect_twins(make_soup(r, s), samples(spp(8)), 16, whole(s)), 0u);
    }
}

TEST_P(CoverTwins, AgreeForOrthographicViews) {
    Random r(25);
    for (int i = 0; i < 4 * effort(); ++i) {
        Soup s = soup();
        s.orthographic = true;
        s.triangles = 3;
        EXPECT_GT(expect_twins(make_soup(r, s), samples(spp(8)), 32, whole(s)), 0u);
    }
}

TEST_P(CoverTwins, AgreeForSqueezedCirclesOfConfusion) {
    Random r(26);
    for (const double ratio : {0.5, 1.8}) {
        Soup s = soup();
        s.ratio = ratio;
        s.triangles = 3;
        EXPECT_GT(expect_twins(make_soup(r, s), samples(spp(8), ratio), 32, whole(s)), 0u);
    }
}

TEST_P(CoverTwins, AgreeForMaskedAndBlendedSurfaces) {
    Random r(27);
    for (const AlphaMode alpha : {AlphaMode::kMask, AlphaMode::kBlend})
        // Thresholds permute the next power of two; those over time have digits of two bits and of one.
        for (const int count : {spp(8), 11, 1, 2, 4, 16, 32}) {
            Soup s = soup();
            s.alpha = alpha;
            s.triangles = 3;
            EXPECT_GT(expect_twins(make_soup(r, s), samples(count), 32, whole(s)), 0u);
        }
}

TEST_P(CoverTwins, AgreeUnderARollingShutter) {
    Random r(32);
    for (const RollingShutter edge :
         {RollingShutter::kTop, RollingShutter::kBottom, RollingShutter::kLeft, RollingShutter::kRight}) {
        Soup s = soup();
        s.width = r.between(30, 100);
        s.height = r.between(30, 70);
        s.triangles = 3;
        Shutter shutter;
        shutter.close = 1.0;
        shutter.rolling = edge;
        shutter.exposure_share = 0.3 * r.below(3);
        if (r.below(2) == 0) shutter.curve = ShutterCurve(trapezoid_shutter(0.2, 0.4));
        const SampleTable rolled(spp(8), 7, Lens{}, GetParam().grouping, SamplePattern::kFree,
                                 SampleTimes(shutter, s.width, s.height));
        EXPECT_GT(expect_twins(make_soup(r, s), rolled, 8 << r.below(3), whole(s)), 0u);
    }
}

TEST_P(CoverTwins, AgreeInsideACrop) {
    Random r(28);
    for (int i = 0; i < 4 * effort(); ++i) {
        Soup s = soup();
        s.triangles = 3;
        const int x0 = r.below(40), y0 = r.below(30);
        expect_twins(make_soup(r, s), samples(spp(4)), 8 << r.below(3),
                     {x0, r.between(x0 + 1, s.width), y0, r.between(y0 + 1, s.height)});
    }
}

TEST_P(CoverTwins, AgreeForNumbersOfAnySize) {
    Random r(29);
    for (const double magnify : {1e-9, 1e-4, 1e4, 1e8, 1e9, 2e10, 7e10}) {
        Soup s = soup();
        s.magnify = magnify;
        s.triangles = 3;
        expect_twins(make_soup(r, s), samples(spp(4)), 32, whole(s));
    }
}

TEST_P(CoverTwins, AgreeForTrianglesThatRushAtTheCamera) {
    // w from far to just in front of the near plane, in layers that nearly coincide: the rounding of r - q shows at the
    // end.
    Random r(30);
    for (int i = 0; i < 4 * effort(); ++i) {
        Soup s = soup();
        s.classes = {Hard::kGeneric};
        s.triangles = 40;
        Frame frame = make_soup(r, s);
        for (std::size_t p = 0; p < frame.points.size(); ++p) {
            const bool far = p / frame.parts[0].vertex_count % 2 == 0;
            const double w = far ? r.magnitude(1e3, 1e7) : 0.05 * (1 + r.unit() * 1e-3);
            glm::vec4& point = frame.points[p];
            point = glm::vec4(glm::vec2(point) / point.z * static_cast<float>(w), static_cast<float>(w), point.w);
        }
        expect_twins(frame, samples(spp(4)), 32, whole(s));
    }
}

// Vectors cross the segments, and each sample takes its own.
TEST_P(CoverTwins, AgreeForPathsOfManySegments) {
    Random r(35);
    for (const int segments : {2, 7, 8, 16, 32, 64})
        for (const int count : {spp(16), spp(4), 7}) {
            Soup s = soup();
            s.segments = segments;
            s.single_sided = segments == 16;
            s.orthographic = segments == 32 && count == 7;
            if (segments == 8) s.alpha = AlphaMode::kBlend;
            s.triangles = 2;
            EXPECT_GT(expect_twins(make_soup(r, s), samples(count), segments == 64 ? 16 : 32, whole(s)), 0u);
        }
}

TEST(CoverTwinsOfOneFrame, SegmentsThatVectorsCrossStayTogether) {
    Random r(36);
    Soup s;
    s.segments = 8;
    s.triangles = 30;
    const Frame frame = make_soup(r, s);
    const PixelRect whole{0, s.width, 0, s.height};
    const Bins bins(frame, 32, whole);
    std::size_t together = 0;
    for (const Tile tile : {Tile{0, 0, 32, 32}, Tile{32, 0, 64, 32}}) {
        const auto listed = bins.tile(tile.x0, tile.y0);
        const TileWork work{frame, table(16, Grouping::kBoth, 1.0), bins.triangles(), listed, tile, nullptr};
        const ClusteredOrder order = clustered_front_to_back(work, 0.25f);
        EXPECT_TRUE(std::is_permutation(listed.begin(), listed.end(), order.entries.begin(), order.entries.end()));
        EXPECT_TRUE(std::is_sorted(order.nearest.begin(), order.nearest.end()));
        std::map<std::pair<std::uint32_t, int>, std::size_t> place;
        const auto binned = [&](std::size_t i) { return bins.triangles()[order.entries[i]]; };
        for (std::size_t i = 0; i < order.entries.size(); ++i) {
            EXPECT_LE(order.nearest[i], nearest_depth(work, binned(i)));
            place[{binned(i).triangle, binned(i).segment}] = i;
        }
        for (const auto& [segment, i] : place) {
            const auto next = place.find({segment.first, segment.second + 1});
            if (next == place.end()) continue;
            EXPECT_EQ(next->second, i + 1);
            ++together;
        }
    }
    EXPECT_GT(together, 100u);
}

// A mesh of triangles of about a pixel, all of which blur alike: what clusters are made of. The first ones of some
// reach the camera plane.
Frame make_mesh(Random& r, const Soup& soup, std::uint32_t side = 40, double widest_circle = 12.0) {
    Soup none = soup;
    none.triangles = 0;
    none.classes = {Hard::kGeneric};
    Frame frame = make_soup(r, none);
    Part& part = frame.parts[0];
    part.moves = soup.motion;
    part.segments = part.moves ? r.between(1, 4) : 1;
    part.vertex_count = (side + 1) * (side + 1);
    part.triangle_count = 2 * side * side;
    const float step = static_cast<float>(r.magnitude(0.2, 1.0)), reach = static_cast<float>(r.magnitude(0.5, 12.0));
    const auto circle = static_cast<float>(r.magnitude(widest_circle / 24, widest_circle));
    const bool behind = r.chance(0.3);
    for (int knot = 0; knot <= (part.moves ? part.segments : 0); ++knot) {
        const auto at = [&] { return reach * static_cast<float>(r.unit() - 0.5); };
        const float x = at(), y = at(), c = soup.defocus ? at() * circle / reach : 0.0f,
                    w = 2.0f + static_cast<float>(r.unit());
        for (std::uint32_t v = 0; v < part.vertex_count; ++v) {
            const auto jitter = [&] { return 0.3f * step * static_cast<float>(r.unit()); };
            const float vw = behind && v < 3 ? -1.0f : w + 0.1f * jitter();
            const float vx = x + step * (static_cast<float>(v % (side + 1)) - side / 2.0f) + jitter(),
                        vy = y + step * (static_cast<float>(v / (side + 1)) - side / 2.0f) + jitter();
            frame.points.emplace_back(vx * vw, vy * vw, vw, c * vw);
        }
    }
    for (std::uint32_t q = 0; q < side * side; ++q) {
        const std::uint32_t v = q / side * (side + 1) + q % side;
        for (const std::uint32_t corner : {v, v + 1, v + side + 1, v + side + 1, v + 1, v + side + 2})
            frame.corners.push_back(corner);
    }
    frame.part_of.assign(part.triangle_count, 0);
    return frame;
}

TEST_P(CoverTwins, AgreeForClusters) {
    Random r(33);
    std::size_t clustered = 0, walked = 0;
    for (int i = 0; i < 4 * effort(); ++i) {
        Soup s = soup();
        s.width = s.height = 32;
        s.ratio = i % 3 == 1 ? 1.7 : 1.0;
        s.single_sided = i % 4 == 2;
        if (i % 4 == 3) s.alpha = AlphaMode::kBlend;
        const Frame frame = make_mesh(r, s);
        const SampleTable& table = samples(spp(i % 2 == 0 ? 16 : 6), s.ratio);
        expect_twins(frame, table, 32, whole(s));
        const Bins bins(frame, 32, whole(s));
        const auto listed = bins.tile(0, 0);
        const ClusteredOrder order =
            clustered_front_to_back({frame, table, bins.triangles(), listed, {0, 0, 32, 32}, nullptr}, 0.25f);
        clustered += kLanes * order.clusters.size();
        walked += order.entries.size();
        EXPECT_TRUE(std::is_permutation(listed.begin(), listed.end(), order.entries.begin(), order.entries.end()));
    }
    EXPECT_GT(4 * clustered, walked) << "many of these must be clusters, or nothing is tested here";
}

TEST(CoverTwinsOfOneFrame, AgreeForWideBlur) {
    for (const Grouping grouping : {Grouping::kDefocus, Grouping::kBoth}) {
        Random r(34);
        int wide = 0, tiles = 0;
        for (const int spp : {16, 16, 48, 64, 16}) {
            Soup s;
            s.motion = grouping == Grouping::kBoth;
            s.width = 64;
            s.height = 60;  // the lower tiles are cut
            s.ratio = tiles % 3 == 1 ? 1.7 : 1.0;
            if (tiles % 4 == 0) s.alpha = AlphaMode::kBlend;
            const Frame frame = make_mesh(r, s, 8, 1500.0);  // finer cells cross its segments
            const SampleTable& samples = table(spp, grouping, s.ratio);
            const PixelRect whole{0, s.width, 0, s.height};
            EXPECT_GT(expect_twins(frame, samples, 32, whole), 0u);
            const Bins bins(frame, 32, whole);
            const auto is_wide = [&](const Tile& tile) {
                return blurs_widely({frame, samples, bins.triangles(), bins.tile(tile.x0, tile.y0), tile, nullptr});
            };
            for (const int x : {0, 32}) {
                wide += is_wide({x, 0, x + 32, 32});
                EXPECT_FALSE(is_wide({x, 32, x + 32, 60}));
                ++tiles;
            }
        }
        EXPECT_GT(8 * wide, tiles) << wide << " of " << tiles
                                   << ": some of these must be taken by the finer cells, or nothing is tested here";
    }
}

// A table is arranged for one kind of blur, but holds for every frame.
TEST(CoverTwinsOfOneFrame, AgreeForTablesThatAreGroupedForAnotherBlur) {
    Random r(31);
    Soup s;
    s.triangles = 2;
    const Frame frame = make_soup(r, s);
    for (const Grouping grouping : {Grouping::kStill, Grouping::kMotion, Grouping::kDefocus})
        for (const int spp : {4, 13, 16}) expect_twins(frame, table(spp, grouping, 1.0), 32, {0, s.width, 0, s.height});
}

INSTANTIATE_TEST_SUITE_P(
    Property, CoverTwins,
    ::testing::Values(Blur{"Still", false, false, Grouping::kStill}, Blur{"Motion", true, false, Grouping::kMotion},
                      Blur{"Defocus", false, true, Grouping::kDefocus}, Blur{"Both", true, true, Grouping::kBoth},
                      Blur{"Accumulation", true, true, Grouping::kBoth, SamplePattern::kAccumulation},
                      Blur{"AccumulationOfMotion", true, false, Grouping::kMotion, SamplePattern::kAccumulation},
                      Blur{"Interleaved", true, true, Grouping::kBoth, SamplePattern::kInterleaved}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace pentaprism
