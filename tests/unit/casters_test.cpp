#include "shade/casters.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <vector>

#include "shade/find_casters.h"
#include "support/isa.h"
#include "support/random.h"

namespace pentaprism {
namespace {

// Parts of triangles around a light at the origin, many of them behind it or across its plane, some far too large.
struct World {
    WorldMotion motion;
    Frame frame;  // all of it is solid

    World() { motion.frame = &frame; }
    explicit World(support::Random& random) : World() {
        for (int i = 0; i < 12; ++i) add_part(random, random.between(1, 90), random.between(0, 3));
    }
    World(const World&) = delete;
    World& operator=(const World&) = delete;
    void add_part(support::Random& random, int triangles, int segments) {
        Part part;
        part.first_triangle = static_cast<std::uint32_t>(frame.part_of.size());
        part.triangle_count = static_cast<std::uint32_t>(triangles);
        part.first_point = static_cast<std::uint32_t>(motion.points.size());
        part.vertex_count = 3 * part.triangle_count;
        part.moves = segments > 0;
        part.segments = std::max(segments, 1);
        const auto first = static_cast<std::uint32_t>(frame.corners.size());  // the frame has other knots
        motion.shifts.push_back(part.first_point - first);
        for (std::uint32_t i = 0; i < part.vertex_count; ++i) frame.corners.push_back(first + i);
        frame.part_of.insert(frame.part_of.end(), part.triangle_count, static_cast<std::uint32_t>(motion.parts.size()));
        const int knots = segments + 1;
        std::vector<glm::vec3> places;
        for (int t = 0; t < triangles; ++t) {
            const float size = static_cast<float>(random.magnitude(1e-3, random.chance(0.05) ? 1e14 : 10.0));
            const glm::vec3 middle(random.range(-4, 4), random.range(-4, 4), random.range(-2, 6));
            for (int k = 0; k < 3; ++k)
                places.push_back(middle +
                                 size * glm::vec3(random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)));
        }
        for (int knot = 0; knot < knots; ++knot)
            for (glm::vec3& p : places) {
                motion.points.push_back(p);
                p += glm::vec3(random.range(-0.2, 0.2), random.range(-0.2, 0.2), random.range(-0.2, 0.2));
            }
        motion.parts.push_back(part);
        motion.bounds.push_back({glm::vec3(-1e15f), glm::vec3(1e15f)});
        frame.parts = motion.parts;
    }
};

LightView random_view(support::Random& random) {
    LightView view;
    view.perspective = random.chance(0.7);
    if (view.perspective) view.position = {random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
    return view;
}

bool equal(const Casters& a, const Casters& b) {
    if (a.count != b.count) return false;
    for (std::uint32_t i = 0; i < a.count; ++i) {
        const Casters::Boxes &p = a.boxes[i / Casters::kLanes], &q = b.boxes[i / Casters::kLanes];
        const std::uint32_t lane = i % Casters::kLanes;
        if (p.x0[lane] != q.x0[lane] || p.x1[lane] != q.x1[lane] || p.y0[lane] != q.y0[lane] ||
            p.y1[lane] != q.y1[lane] || p.limit[lane] != q.limit[lane] || p.triangle(lane) != q.triangle(lane) ||
            p.segment[lane] != q.segment[lane] || p.is_mixed(lane) != q.is_mixed(lane))
            return false;
    }
    return true;
}

TEST(Casters, AreTheSameOnEveryCpuTargetAndOnAllCores) {
    support::Random random(5);
    std::uint32_t count = 0;
    for (int round = 0; round < 20; ++round) {
        const World world(random);
        const LightView view = random_view(random);
        const Casters casters = make_casters(world.motion, view, false);
        count += casters.count;
        EXPECT_TRUE(equal(casters, make_casters(world.motion, view, true)));
        for (const char* isa : {"scalar", "avx2", "avx512"}) {
            if (!support::has_isa(isa)) continue;
            const support::UseIsa use(isa);
            EXPECT_TRUE(equal(casters, make_casters(world.motion, view, false))) << isa;
        }
    }
    EXPECT_GT(count, 5000u);
}

// A point of each triangle at some time, in double: where it is seen it is in one of the triangle's boxes, and no limit
// leaves it out that lies beyond it.
TEST(Casters, HoldWhateverTheLightSeesOfThem) {
    support::Random random(6);
    std::size_t seen = 0, lost = 0;
    for (int round = 0; round < 100; ++round) {
        const World world(random);
        const LightView view = random_view(random);
        const Casters casters = make_casters(world.motion, view, false);
        for (int n = 0; n < 20000; ++n) {
            const std::uint32_t triangle =
                static_cast<std::uint32_t>(random.below(static_cast<int>(world.frame.part_of.size())));
            const Part& part = world.motion.part_of(triangle);
            const int segment = random.below(part.segments);
            const double s = random.biased();
            double b[3] = {random.biased(), random.biased(), 0.0};
            if (b[0] + b[1] > 1.0) b[0] = 1.0 - b[0], b[1] = 1.0 - b[1];
            b[2] = 1.0 - b[0] - b[1];
            glm::dvec3 p(0.0);
            bool usable = true;
            for (int k = 0; k < 3; ++k) {
                const std::size_t at = world.motion.corners(triangle)[k] + segment * part.vertex_count;
                const glm::vec3 open = view.place(world.motion.points[at]);
                const glm::vec3 close = part.moves ? view.place(world.motion.points[at + part.vertex_count]) : open;
                for (const glm::vec3& v : {open, close})
                    for (int axis = 0; axis < 3; ++axis) usable = usable && std::abs(v[axis]) <= kLargestOfCasters;
                p += b[k] * ((1.0 - s) * glm::dvec3(open) + s * glm::dvec3(close));
            }
            const double w = view.perspective ? p.z : 1.0, x = p.x / w, y = p.y / w;
            if (!usable || w < kNearestToLight) continue;
            if (view.perspective && std::max(std::abs(x), std::abs(y)) > kWidestTangent) continue;
            ++seen;
            bool held = false;
            for (std::uint32_t i = 0; i < casters.count && !held; ++i) {
                const Casters::Boxes& boxes = casters.boxes[i / Casters::kLanes];
                const std::uint32_t lane = i % Casters::kLanes;
                held = boxes.triangle(lane) == triangle && boxes.segment[lane] == segment && boxes.x0[lane] <= x &&
                       boxes.x1[lane] >= x && boxes.y0[lane] <= y && boxes.y1[lane] >= y &&
                       boxes.limit[lane] <= limit_of(static_cast<float>(p.z), view.perspective);
            }
            lost += !held;
        }
    }
    EXPECT_GT(seen, 100000u);
    EXPECT_EQ(lost, 0u);
}

// Of long parts a triangle here and there before the light, the others behind it.
TEST(Casters, KeepTheirNumbersHoweverFarApartTheyAre) {
    support::Random random(8);
    for (const double share : {0.5, 0.02, 0.002}) {
        World world;
        for (const int segments : {0, 2, 1}) world.add_part(random, random.between(9000, 15000), segments);
        std::vector<std::pair<std::uint32_t, int>> expected, found;
        for (std::uint32_t triangle = 0; triangle < world.frame.part_of.size(); ++triangle) {
            const Part& part = world.motion.part_of(triangle);
            const bool seen = random.chance(share);
            for (const std::uint32_t corner : world.motion.corners(triangle))
                for (int knot = 0; knot < (part.moves ? part.segments + 1 : 1); ++knot)
                    world.motion.points[corner + knot * part.vertex_count] = {
                        random.range(-0.1, 0.1), random.range(-0.1, 0.1), seen ? 1.0f : -1.0f};
            for (int segment = 0; seen && segment < part.segments; ++segment) expected.emplace_back(triangle, segment);
        }
        LightView view;
        view.perspective = true;
        const Casters casters = make_casters(world.motion, view, false);
        for (std::uint32_t i = 0; i < casters.count; ++i) {
            const Casters::Boxes& boxes = casters.boxes[i / Casters::kLanes];
            const std::uint32_t lane = i % Casters::kLanes;
            if (boxes.x0[lane] <= boxes.x1[lane]) found.emplace_back(boxes.triangle(lane), boxes.segment[lane]);
        }
        EXPECT_EQ(found, expected) << share;
        EXPECT_TRUE(equal(casters, make_casters(world.motion, view, true))) << share;
    }
}

TEST(Casters, AreFoundAsByAskingEachBox) {
    support::Random random(7);
    std::size_t found = 0;
    for (int round = 0; round < 40; ++round) {
        const World world(random);
        const LightView view = random_view(random);
        const Casters casters = make_casters(world.motion, view, false);
        for (int n = 0; n < 50; ++n) {
            const float x = static_cast<float>(random.range(-1.5, 1.5)),
                        y = static_cast<float>(random.range(-1.5, 1.5)),
                        size = static_cast<float>(random.magnitude(1e-3, 2.0));
            const CasterQuery query{x, x + size, y, y + size, random.below(kLimits)};
            std::vector<std::uint32_t> expected, room;
            for (std::uint32_t i = 0; i < casters.count; ++i) {
                const Casters::Boxes& boxes = casters.boxes[i / Casters::kLanes];
                const std::uint32_t lane = i % Casters::kLanes;
                if (boxes.x0[lane] <= query.x1 && boxes.x1[lane] >= query.x0 && boxes.y0[lane] <= query.y1 &&
                    boxes.y1[lane] >= query.y0 && boxes.limit[lane] <= query.limit)
                    expected.push_back(i);
            }
            found += expected.size();
            for (const char* isa : {"scalar", "avx2", "avx512"}) {
                if (!support::has_isa(isa)) continue;
                const support::UseIsa use(isa);
                room.resize(find_casters()(casters, query, room));
                EXPECT_EQ(room, expected) << isa;
            }
        }
    }
    EXPECT_GT(found, 10000u);
}

}  // namespace
}  // namespace pentaprism
