// The camera model of docs/develop/algorithms.md 1.3 against first principles: a ray from a point of the lens through
// the point of the focus plane that the pixel looks at, met with a triangle in camera space (Moeller & Trumbore 1997).

#include "peer/brute_force.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <optional>
#include <random>

#include "support/random_frame.h"

namespace pentaprism {
namespace {

using glm::dvec3;

struct Ray {
    dvec3 origin, direction;  // camera space with the depth as z: x right, y up, z into the picture
};

struct RayHit {
    double depth, barycentrics[3], margin;  // margin: smallest barycentric; below 0: beside the triangle
    bool front;
};

/// The light that reaches the picture at (gx, gy) through the point (u, v) of the lens.
Ray ray_of(const View& view, const PlacedSample& s) {
    const double radius = view.lens.radius, focus = view.lens.pinhole() ? 1.0 : view.lens.focus_distance;
    const dvec3 through_the_middle =
        view.perspective ? dvec3(s.gx / view.fx, s.gy / view.fy, 1.0) : dvec3(0.0, 0.0, 1.0);
    const dvec3 from = view.perspective ? dvec3(0.0) : dvec3(s.gx / view.fx, s.gy / view.fy, 0.0);
    const dvec3 in_focus = from + through_the_middle * focus;
    const dvec3 on_lens = from + dvec3(s.u * radius, s.v * radius, 0.0);
    return {on_lens, in_focus - on_lens};
}

std::optional<RayHit> meet(const Ray& ray, const dvec3 p[3]) {
    const dvec3 e1 = p[1] - p[0], e2 = p[2] - p[0], q = glm::cross(ray.direction, e2);
    const double determinant = glm::dot(e1, q);
    if (std::abs(determinant) < 1e-12) return {};
    const dvec3 from = ray.origin - p[0], r = glm::cross(from, e1);
    const double b1 = glm::dot(from, q) / determinant, b2 = glm::dot(ray.direction, r) / determinant;
    const double distance = glm::dot(e2, r) / determinant;
    const double depth = ray.origin.z + distance * ray.direction.z;
    // z points into the picture here, so the frame is left-handed and counter-clockwise means a negative determinant.
    return RayHit{depth, {1 - b1 - b2, b1, b2}, std::min({1 - b1 - b2, b1, b2}), determinant < 0};
}

/// A corner at shutter fraction t, in camera space, straight from the frame's points.
dvec3 corner_at(const Frame& frame, std::uint32_t triangle, int i, double t) {
    const Part& part = frame.parts[0];
    const double scaled = t * part.segments;
    const int segment = part.moves ? static_cast<int>(scaled) : 0;
    dvec3 ends[2];
    for (int end = 0; end < 2; ++end) {
        const std::size_t at = frame.corners[3 * triangle + i] + (part.moves ? (segment + end) * part.vertex_count : 0);
        const glm::dvec4 p(frame.points[at]);
        ends[end] = {p.x / frame.view.fx, p.y / frame.view.fy, frame.view.perspective ? p.z : frame.depths[at]};
    }
    return ends[0] + (ends[1] - ends[0]) * (scaled - segment);
}

class CameraModel : public ::testing::TestWithParam<testing::RandomFrame> {};

TEST_P(CameraModel, SeesWhatARayThroughLensAndFocusPointMeets) {
    std::mt19937 random(7);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    int hits = 0;
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
        const Frame frame = testing::make_random_frame(GetParam(), seed);
        const View& view = frame.view;
        for (int n = 0; n < 400; ++n) {
            const int px = static_cast<int>(uniform(0, view.width)), py = static_cast<int>(uniform(0, view.height));
            double u, v;
            do {
                u = uniform(-1, 1), v = uniform(-1, 1);
            } while (u * u + v * v > 1);
            const SamplePoint point{std::floor(static_cast<float>(uniform(0, 256))) / 256.0f,
                                    std::floor(static_cast<float>(uniform(0, 256))) / 256.0f, static_cast<float>(u),
                                    static_cast<float>(v), static_cast<float>(uniform(0, 0.999))};
            const PlacedSample sample = place_sample(view, point, px, py, 0, OpacityPattern{1, 0});
            const Ray ray = ray_of(view, sample);
            for (std::uint32_t triangle = 0; triangle < frame.triangle_count(); ++triangle) {
                const dvec3 p[3] = {corner_at(frame, triangle, 0, sample.t), corner_at(frame, triangle, 1, sample.t),
                                    corner_at(frame, triangle, 2, sample.t)};
                const std::optional<RayHit> expected = meet(ray, p);
                if (!expected || std::abs(expected->margin) < 1e-8) continue;  // edge-on, or on an edge
                if (std::abs(expected->depth - view.depth_near) < 1e-8) continue;
                const bool visible = expected->margin > 0 && expected->depth >= view.depth_near &&
                                     expected->depth <= view.depth_far && (expected->front || frame.parts[0].two_sided);
                const ExactHit hit = cover_in_double(frame, triangle, sample);
                ASSERT_EQ(hit.hit(), visible) << "seed " << seed << " triangle " << triangle << " margin "
                                              << expected->margin << " depth " << expected->depth;
                if (!visible) continue;
                ++hits;
                EXPECT_NEAR(hit.depth / expected->depth, 1.0, 1e-6);
                EXPECT_EQ(hit.front, expected->front);
                for (int i = 0; i < 3; ++i) EXPECT_NEAR(hit.barycentrics[i], expected->barycentrics[i], 1e-6);
            }
        }
    }
    EXPECT_GT(hits, 400);
}

testing::RandomFrame with(void (*change)(testing::RandomFrame&)) {
    testing::RandomFrame frame;
    change(frame);
    return frame;
}

INSTANTIATE_TEST_SUITE_P(
    Cameras, CameraModel,
    ::testing::Values(
        with([](testing::RandomFrame& f) { f.lens_radius = 0, f.speed = 0; }),
        with([](testing::RandomFrame& f) { f.lens_radius = 0; }),
        with([](testing::RandomFrame& f) { f.speed = 0, f.lens_radius = 0.2; }),
        with([](testing::RandomFrame& f) { f.lens_radius = 0.2, f.segments = 3, f.two_sided = false; }),
        with([](testing::RandomFrame& f) { f.nearest = -1.0, f.farthest = 1.0, f.speed = 2.0, f.size = 2.0; }),
        with([](testing::RandomFrame& f) { f.perspective = false, f.lens_radius = 0.2; }),
        with([](testing::RandomFrame& f) { f.perspective = false, f.segments = 2, f.two_sided = false; })));

TEST(BruteForce, TakesTheLowerOfTwoCoincidentTriangles) {
    Frame frame = testing::make_random_frame({.triangles = 1, .lens_radius = 0, .speed = 0}, 1);
    frame.points = {{-20, -20, 2, 0}, {20, -20, 2, 0}, {-20, 20, 3, 0}};
    frame.corners.insert(frame.corners.end(), {0u, 1u, 2u});
    frame.part_of.push_back(0);
    frame.parts[0].triangle_count = 2;
    const SampleTable table(4, 0, frame.view.lens, Grouping::kStill);
    int hits = 0;
    for (const ExactHit& hit : render_brute_force(frame, table)) {
        EXPECT_NE(hit.triangle, 1u);
        hits += hit.triangle == 0;
    }
    EXPECT_GT(hits, 20);
}

TEST(BruteForce, NeverLeavesAGapOrADoubleHitOnTheEdgeOfTwoTriangles) {
    // A square of two triangles whose diagonal runs through sample positions of the lattice.
    Frame frame =
        testing::make_random_frame({.width = 32, .height = 32, .triangles = 2, .lens_radius = 0, .speed = 0}, 1);
    const glm::vec4 square[4] = {{-16, -16, 2, 0}, {16, -16, 2, 0}, {16, 16, 2, 0}, {-16, 16, 2, 0}};
    frame.points.assign(square, square + 4);
    frame.parts[0].vertex_count = 4;
    frame.corners = {0, 1, 2, 0, 2, 3};
    for (int i = -7 * 16; i <= 7 * 16; ++i) {
        const SamplePoint point{(i & 15) / 16.0f, (-i & 15) / 16.0f, 0, 0, 0};
        const int px = 16 + (i >> 4), py = 16 + (-i >> 4);
        const PlacedSample sample = place_sample(frame.view, point, px, py, 0, OpacityPattern{1, 0});
        ASSERT_EQ(sample.gx, sample.gy);
        EXPECT_NE(cover_in_double(frame, 0, sample).hit(), cover_in_double(frame, 1, sample).hit()) << i;
    }
}

TEST(BruteForce, MeasuresTheDistanceToTheNearestProjectedEdge) {
    Frame frame =
        testing::make_random_frame({.width = 32, .height = 32, .triangles = 1, .lens_radius = 0, .speed = 0}, 1);
    frame.points = {{-20, -20, 2, 0}, {20, -20, 2, 0}, {-20, 20, 2, 0}};  // legs at -10 pixels, hypotenuse x + y = 0
    const auto distance = [&](double gx, double gy) {
        PlacedSample sample;
        sample.gx = gx, sample.gy = gy;
        return distance_to_outline(frame, 0, sample);
    };
    EXPECT_NEAR(distance(-8, -5), 2.0, 1e-12);
    EXPECT_NEAR(distance(-13, -5), 3.0, 1e-12);
    EXPECT_NEAR(distance(3, 3), 3.0 * std::sqrt(2.0), 1e-12);
    EXPECT_NEAR(distance(-13, -14), 5.0, 1e-12);
    // A corner behind the camera: the outline ends where the near plane cuts it.
    frame.points[2] = {-20, 20, -2, 0};
    EXPECT_TRUE(std::isfinite(distance(0, 0)));
    for (glm::vec4& point : frame.points) point.z = -1;
    EXPECT_FALSE(std::isfinite(distance(0, 0)));
}

}  // namespace
}  // namespace pentaprism
