// The comparison that `verify` rests on: it agrees with a right renderer, names a wrong one, and the references agree.

#include <algorithm>
#include <cstdlib>
#include <gtest/gtest.h>
#include <pentaprism/error.h>

#include "bound/local_triangle.h"
#include "cover/exact.h"
#include "peer/reference.h"
#include "render/visibility.h"
#include "support/random_frame.h"

namespace pentaprism {
namespace {

using testing::RandomFrame;

/// A sample of a tile and its entry in Hits.
struct TileSample {
    int px, py, index;
    std::size_t entry;
    LocalSample local;
};

std::vector<TileSample> samples_of(const SampleTable& table, const Tile& tile, const Hits& hits) {
    std::vector<TileSample> samples;
    for (int py = tile.y0; py < tile.y1; ++py) {
        for (int px = tile.x0; px < tile.x1; ++px) {
            for (int index = 0; index < table.spp(); ++index) {
                const std::size_t entry = hits.entry(px, py, table.slot_of(px, py, index));
                samples.push_back({px, py, index, entry, local_sample(table.sample(px, py, index), px, py)});
            }
        }
    }
    return samples;
}

/// The renderer's scalar coverage test on every triangle: visibility without bins, culling or vectors.
TileTracer scalar_tracer(const Frame& frame, const SampleTable& table) {
    return [&](const Tile& tile, Hits& hits) {
        const CellCentre centre = cell_centre(frame.view, tile.cell_x(), tile.cell_y());
        const std::vector<TileSample> samples = samples_of(table, tile, hits);
        for (std::uint32_t triangle = 0; triangle < frame.triangle_count(); ++triangle) {
            const Part& part = frame.parts[frame.part_of[triangle]];
            for (int segment = 0; segment < (part.moves ? part.segments : 1); ++segment) {
                const LocalTriangle local = localize(frame, triangle, segment, centre);
                for (const TileSample& sample : samples) {
                    const SampleHit hit = cover_sample(local, sample.local, centre);
                    if (hit.hit && hit.depth < hits.depth[sample.entry]) {
                        hits.depth[sample.entry] = hit.depth;
                        hits.triangle[sample.entry] = triangle;
                    }
                }
            }
        }
    };
}

/// The renderer's visibility, every stage of it.
TileTracer renderer(const Visibility& visibility) {
    return [&](const Tile& tile, Hits& hits) {
        CoverCounts counts;
        visibility.cover(tile, hits, counts);
    };
}

/// Fails the test, saying what is wrong, for a sample that rounding does not explain.
void expect_near_edge(const Verdict& verdict) {
    const Claim& claim = verdict.claim;
    EXPECT_FALSE(verdict.away_from_edge())
        << "pixel " << claim.px << ' ' << claim.py << " index " << claim.index << ": " << claim.triangle << " at "
        << claim.depth << ", not " << verdict.truth.triangle << " at " << verdict.truth.depth << "; " << verdict.margin
        << " pixels from an edge";
}

class References : public ::testing::TestWithParam<RandomFrame> {};

TEST_P(References, AgreeWithTheRendererButForRoundingAtEdges) {
    std::int64_t samples = 0, wrong = 0;
    for (std::uint32_t seed = 0; seed < 8; ++seed) {
        const Frame frame = testing::make_random_frame(GetParam(), seed);
        const SampleTable table(16, seed, frame.view.lens, grouping_for(frame));
        const Visibility visibility(frame, table, {}, {0, frame.view.width, 0, frame.view.height});
        const Reference reference = make_reference(frame, table);
        CompareOptions options;
        options.on_disagreement = expect_near_edge;
        const VerifyReport report = compare_tracers(frame, table, renderer(visibility), reference.tracer, options);
        samples += report.samples;
        wrong += report.ours_wrong;
        EXPECT_LE(report.worst_margin, kEdgeTolerance);
        EXPECT_GT(report.brute_force_samples, 10000);
    }
    EXPECT_LE(wrong, 1) << "of " << samples;
}

RandomFrame with(void (*change)(RandomFrame&)) {
    RandomFrame frame;
    change(frame);
    return frame;
}

INSTANTIATE_TEST_SUITE_P(
    Frames, References,
    ::testing::Values(with([](RandomFrame& f) { f.lens_radius = 0, f.speed = 0; }),       // still
                      with([](RandomFrame& f) { f.lens_radius = 0, f.speed = 5; }),       // fast
                      with([](RandomFrame& f) { f.lens_radius = 0.3, f.speed = 0; }),     // far out of focus
                      with([](RandomFrame& f) { f.segments = 4, f.two_sided = false; }),  // bent paths
                      with([](RandomFrame& f) {
                          f.size = 0.03, f.triangles = 150, f.width = 32, f.height = 32;
                      }),  // tiny
                      with([](RandomFrame& f) { f.perspective = false; })));

/// Where vertices lie far beyond what is seen of the triangle, its float depth is less exact; the triangle must be
/// right.
void expect_right_triangle(const Verdict& verdict) {
    if (verdict.claim.triangle == verdict.truth.triangle) {
        EXPECT_LT(verdict.depth_difference, 1e-3);
    } else {
        expect_near_edge(verdict);
    }
}

TEST(Comparison, JudgesSliversAndTrianglesAcrossTheCameraPlaneByTheirDistanceInPixels) {
    for (const RandomFrame& wanted : {with([](RandomFrame& f) { f.thinness = 1e-4; }), with([](RandomFrame& f) {
                                          f.nearest = -1, f.farthest = 1, f.speed = 2, f.size = 2;
                                      })}) {
        for (std::uint32_t seed = 0; seed < 3; ++seed) {
            const Frame frame = testing::make_random_frame(wanted, seed);
            const SampleTable table(16, seed, frame.view.lens, grouping_for(frame));
            const Reference reference = make_reference(frame, table);
            CompareOptions options;
            options.on_disagreement = expect_right_triangle;
            const VerifyReport report =
                compare_tracers(frame, table, scalar_tracer(frame, table), reference.tracer, options);
            EXPECT_LE(report.ours_wrong, 3);
        }
    }
}

/// A renderer with a defect, on the frame of the test below.
VerifyReport report_of_defect(void (*spoil)(Hits& hits, std::size_t entry)) {
    const Frame frame = testing::make_random_frame({}, 11);
    const SampleTable table(16, 0, frame.view.lens, Grouping::kBoth);
    const Reference reference = make_reference(frame, table);
    const TileTracer right = scalar_tracer(frame, table);
    const TileTracer wrong = [&](const Tile& tile, Hits& hits) {
        right(tile, hits);
        for (const TileSample& s : samples_of(table, tile, hits)) {
            if (s.px % 16 == 3 && s.py % 8 == 5 && s.index == 7) spoil(hits, s.entry);
        }
    };
    return compare_tracers(frame, table, wrong, reference.tracer, {});
}

TEST(Comparison, ReportsALostTriangle) {
    const VerifyReport report = report_of_defect([](Hits& hits, std::size_t entry) {
        hits.triangle[entry] = kNoTriangle;
        hits.depth[entry] = std::numeric_limits<float>::infinity();
    });
    EXPECT_GT(report.ours_wrong, 5);
    EXPECT_GT(report.away_from_edge, 5);
    EXPECT_GT(report.worst_margin, kEdgeTolerance);
    EXPECT_GT(report.per_million, 100);
}

TEST(Comparison, ReportsAHitOnATriangleThatIsNotThere) {
    const VerifyReport report = report_of_defect([](Hits& hits, std::size_t entry) {
        hits.triangle[entry] = hits.triangle[entry] == 0 ? 1 : 0;
        hits.depth[entry] = 0.7f;
    });
    EXPECT_GE(report.ours_wrong, 15);
    EXPECT_GT(report.away_from_edge, 10);
}

TEST(Comparison, ReportsAWrongDepthOfTheRightTriangle) {
    const VerifyReport report = report_of_defect([](Hits& hits, std::size_t entry) { hits.depth[entry] *= 1.0001f; });
    EXPECT_GT(report.ours_wrong, 5);
    EXPECT_GT(report.away_from_edge, 5);
    EXPECT_NEAR(report.worst_depth_error, 1e-4, 2e-6);
}

TEST(Comparison, FindsDefectsByBruteForceAlone) {
    const Frame frame = testing::make_random_frame({}, 11);
    const SampleTable table(16, 0, frame.view.lens, Grouping::kBoth);
    const TileTracer blind = [](const Tile&, Hits&) {};
    CompareOptions options;
    options.brute_force_samples = 2000;
    const VerifyReport report = compare_tracers(frame, table, blind, {}, options);
    EXPECT_NEAR(static_cast<double>(report.brute_force_samples), 2000, 200);
    EXPECT_GT(report.brute_force_disagreements, 200);
    EXPECT_EQ(report.ours_wrong, report.brute_force_disagreements);
}

TEST(Comparison, CallsTwoCoincidentSurfacesATie) {
    // The second triangle is the first one, turned by one corner and a hair nearer than a float depth can tell.
    Frame frame = testing::make_random_frame({.triangles = 1, .lens_radius = 0, .speed = 0}, 1);
    frame.points = {{-20, -20, 2, 0}, {20, -20, 2, 0}, {-20, 20, 3, 0}};
    for (int i = 0; i < 3; ++i) {
        glm::vec4 p = frame.points[i];
        p.z = std::nextafter(p.z, 0.0f);
        frame.points.push_back(p);
    }
    frame.corners.insert(frame.corners.end(), {4u, 5u, 3u});
    frame.part_of.push_back(0);
    frame.parts[0].triangle_count = 2;
    frame.parts[0].vertex_count = 6;
    const SampleTable table(16, 0, frame.view.lens, Grouping::kStill);
    const TileTracer first_only = [&](const Tile& tile, Hits& hits) {
        scalar_tracer(frame, table)(tile, hits);
        for (std::uint32_t& triangle : hits.triangle) triangle = triangle == 1 ? 0 : triangle;
    };
    CompareOptions options;
    options.brute_force_samples = 1 << 20;
    const VerifyReport report = compare_tracers(frame, table, first_only, {}, options);
    EXPECT_GT(report.depth_ties, 20);
    EXPECT_LE(report.ours_wrong, 1);
}

TEST(Comparison, JudgesOverTheWholeSceneThoughItListsCandidates) {
    const Frame frame = testing::make_random_frame({.triangles = 200, .nearest = -1}, 5);
    const SampleTable table(4, 0, frame.view.lens, Grouping::kBoth);
    const std::vector<ExactHit> truth = render_brute_force(frame, table);
    std::vector<Claim> claims;
    for (int py = 0; py < frame.view.height; ++py) {
        for (int px = 0; px < frame.view.width; ++px) {
            for (int index = 0; index < 4; ++index) claims.push_back({px, py, index});
        }
    }
    const std::vector<Verdict> verdicts = Judge(frame, table).judge(claims);
    for (std::size_t i = 0; i < claims.size(); ++i) ASSERT_EQ(verdicts[i].truth.triangle, truth[i].triangle) << i;
}

TEST(Comparison, StopsWhenToldTo) {
    const Frame frame = testing::make_random_frame({}, 11);
    const SampleTable table(4, 0, frame.view.lens, Grouping::kBoth);
    EXPECT_THROW(compare_tracers(frame, table, scalar_tracer(frame, table), {}, {}, [](double) { return false; }),
                 Error);
}

RenderSettings small_and_blurred() {
    RenderSettings settings;
    settings.image.width = 128;
    settings.image.height = 96;
    settings.camera.fstop = 2.8;
    return settings;
}

void expect_right(const VerifyReport& report) {
    EXPECT_EQ(report.samples, 128 * 96 * 16) << report.scene;
    EXPECT_LE(report.ours_wrong, 1) << report.scene;
    EXPECT_EQ(report.away_from_edge, 0) << report.scene;
    EXPECT_GT(report.brute_force_samples, 100) << report.scene;
    EXPECT_NE(report.reference.find("brute force"), std::string::npos);
}

TEST(Verify, FindsTheRendererRightOnTheSmallestBuiltInScene) {
    const std::vector<BuiltinScene> scenes = builtin_scenes();
    const auto smallest =
        std::min_element(scenes.begin(), scenes.end(),
                         [](const BuiltinScene& a, const BuiltinScene& b) { return a.triangles < b.triangles; });
    ASSERT_NE(smallest, scenes.end());
    expect_right(verify_frame(make_builtin_scene(smallest->name), small_and_blurred(), 5));
}

TEST(Verify, FindsTheRendererRightOnRealScenes) {
    const char* folder = std::getenv("PENTAPRISM_SCENES");
    if (!folder) GTEST_SKIP() << "PENTAPRISM_SCENES is not set";
    for (const char* file :
         {"khronos/CesiumMan/CesiumMan.glb", "khronos/Fox/Fox.glb", "hand/hand.glb",
          "khronos/AlphaBlendModeTest/AlphaBlendModeTest.glb", "khronos/NegativeScaleTest/NegativeScaleTest.glb"}) {
        expect_right(verify_frame(load_scene(std::string(folder) + "/" + file), small_and_blurred(), 5));
    }
}

}  // namespace
}  // namespace pentaprism
