#include "shade/casters.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "base/parallel.h"
#include "bound/screen_bounds.h"
#include "frame/opacity.h"

namespace pentaprism {
namespace {

constexpr float kLargest = 1e12f;

using Ranges = std::function<void(std::size_t, std::size_t)>;

void for_ranges(bool parallel, std::size_t n, const Ranges& body) {
    if (parallel)
        parallel_ranges(n, 1, body);
    else
        body(0, n);
}

// Whether all of a part lies beyond one side of the light's pyramid: with (x, y, z) in the light's view, a side is
// +-x = kWidestTangent z or +-y = kWidestTangent z.
bool is_out_of_view(const WorldMotion::Bounds& bounds, const LightView& view) {
    if (!view.perspective) return false;
    const glm::dvec3 low(bounds.low), high(bounds.high);
    const glm::dvec3 middle = 0.5 * (low + high) - glm::dvec3(view.position), half = 0.5 * (high - low);
    const glm::dmat3 axes(view.axes);
    const auto least = [&](const glm::dvec3& n) { return glm::dot(n, middle) - glm::dot(glm::abs(n), half); };
    const glm::dvec3 side = static_cast<double>(kWidestTangent) * axes[2];
    if (least(-axes[2]) > -static_cast<double>(kNearestToLight)) return true;
    for (int axis = 0; axis < 2; ++axis)
        if (least(axes[axis] - side) > 0.0 || least(-axes[axis] - side) > 0.0) return true;
    return false;
}

// The next float above, as std::nextafter(), which is a call. Not of one that is no number.
float next_above(float x) {
    if (x == 0.0f) return std::numeric_limits<float>::denorm_min();
    const auto bits = std::bit_cast<std::int32_t>(x);
    return x == INFINITY ? x : std::bit_cast<float>(bits + (x > 0.0f ? 1 : -1));
}

float next_below(float x) {
    return -next_above(-x);
}

bool is_usable(const MovingTriangle& m) {
    bool usable = true;
    for (int k = 0; k < 6; ++k)
        for (const float v : {m.x[k / 2][k % 2], m.y[k / 2][k % 2], m.z[k / 2][k % 2]})
            usable = usable && std::abs(v) <= kLargest;
    return usable;
}

// Where boxes are written, one after the other.
class BoxWriter {
  public:
    BoxWriter(Casters::Boxes* boxes, std::size_t first) : boxes_(boxes), next_(first) {}
    std::size_t next() const { return next_; }

    /// If something of the box is in view.
    void add(const ScreenBox& box, bool perspective, float nearest, std::uint32_t triangle, int segment, bool mixed) {
        if (box.empty()) return;
        if (perspective && (box.x0 > kWidestTangent || box.x1 < -kWidestTangent || box.y0 > kWidestTangent ||
                            box.y1 < -kWidestTangent))
            return;
        Casters::Boxes& out = boxes_[next_ / Casters::kLanes];
        const std::size_t lane = next_++ % Casters::kLanes;
        out.x0[lane] = next_below(static_cast<float>(box.x0)), out.x1[lane] = next_above(static_cast<float>(box.x1));
        out.y0[lane] = next_below(static_cast<float>(box.y0)), out.y1[lane] = next_above(static_cast<float>(box.y1));
        out.limit[lane] = static_cast<std::uint8_t>(perspective ? limit_of(nearest, true) : 0);
        out.triangle[lane] = triangle;
        out.segment[lane] = static_cast<std::uint16_t>(segment);
        out.mixed[lane] = mixed;
    }

    void copy(const BoxWriter& from, std::size_t i) {
        const Casters::Boxes& in = from.boxes_[i / Casters::kLanes];
        Casters::Boxes& out = boxes_[next_ / Casters::kLanes];
        const std::size_t was = i % Casters::kLanes, lane = next_++ % Casters::kLanes;
        out.x0[lane] = in.x0[was], out.x1[lane] = in.x1[was], out.y0[lane] = in.y0[was], out.y1[lane] = in.y1[was];
        out.limit[lane] = in.limit[was], out.triangle[lane] = in.triangle[was];
        out.segment[lane] = in.segment[was], out.mixed[lane] = in.mixed[was];
    }

  private:
    Casters::Boxes* boxes_;
    std::size_t next_;
};

void clear(Casters::Extents& extents, std::size_t first) {
    for (std::size_t lane = first; lane < Casters::kLanes; ++lane) {
        extents.x0[lane] = extents.y0[lane] = INFINITY;
        extents.x1[lane] = extents.y1[lane] = -INFINITY;
        extents.limit[lane] = 0xff;
    }
}

// Bounds of sixteen as one.
void unite(const Casters::Extents& all, Casters::Extents& out, std::size_t lane) {
    out.x0[lane] = *std::min_element(all.x0, all.x0 + Casters::kLanes);
    out.x1[lane] = *std::max_element(all.x1, all.x1 + Casters::kLanes);
    out.y0[lane] = *std::min_element(all.y0, all.y0 + Casters::kLanes);
    out.y1[lane] = *std::max_element(all.y1, all.y1 + Casters::kLanes);
    out.limit[lane] = *std::min_element(all.limit, all.limit + Casters::kLanes);
}

template <class T>
std::vector<Casters::Extents> groups_of(const T* parts, std::size_t count) {
    std::vector<Casters::Extents> groups((count + Casters::kLanes - 1) / Casters::kLanes);
    if (!groups.empty()) clear(groups.back(), 0);
    for (std::size_t i = 0; i < count; ++i) unite(parts[i], groups[i / Casters::kLanes], i % Casters::kLanes);
    return groups;
}

// A little before the nearest of the triangle's depths, as rounding may put a sample there.
float nearest_depth(float nearest, float farthest) {
    return nearest - kDepthRounding * std::max(std::abs(nearest), std::abs(farthest));
}

std::size_t knots_of(const Part& part) {
    return part.moves ? static_cast<std::size_t>(part.segments) + 1 : 1;
}

// A part's points on the light's picture.
class SeenPoints {
  public:
    SeenPoints(const WorldMotion& world, const Part& part, const LightView& view)
        : world_(world), part_(part), perspective_(view.perspective) {
        const std::size_t count = part.vertex_count * knots_of(part);
        placed_.resize(count);
        seen_.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            const glm::vec3 p = placed_[i] = view.place(world.points[part.first_point + i]);
            const float w = perspective_ ? p.z : 1.0f, inverse = 1.0f / w;
            seen_[i] = {p.x * inverse, p.y * inverse};
            simple_ = simple_ && w >= kNearestToLight && std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest &&
                      std::abs(p.z) <= kLargest;
        }
    }
    /// Whether box() may be asked.
    bool simple() const { return simple_; }

    // For triangles that are wholly before the light: with the lens closed a moving triangle lies between its six ends
    // as they are seen. A box of its own for each triangle, as screen_bounds() makes it, costs five times as much.
    ScreenBox box(std::uint32_t triangle, int segment, float& nearest) const {
        float x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY, least = INFINITY, most = -INFINITY;
        for (int k = 0; k < 3; ++k)
            for (int end = 0; end < (part_.moves ? 2 : 1); ++end) {
                const std::size_t at = point(triangle, k, segment + end);
                const glm::vec2& p = seen_[at];
                x0 = std::min(x0, p.x), x1 = std::max(x1, p.x);
                y0 = std::min(y0, p.y), y1 = std::max(y1, p.y);
                least = std::min(least, placed_[at].z), most = std::max(most, placed_[at].z);
            }
        nearest = nearest_depth(least, most);
        // As in screen_bounds(), where |x| <= w * reach; a quarter more for the divisions here.
        constexpr float kUnitRoundoff = 1.0f / 16777216.0f;
        const float slack = 20.0f * kUnitRoundoff * (perspective_ ? most / least : 1.0f);
        const float slack_x = slack * (32.0f + 2.0f * std::max(std::abs(x0), std::abs(x1)));
        const float slack_y = slack * (32.0f + 2.0f * std::max(std::abs(y0), std::abs(y1)));
        return {x0 - slack_x, x1 + slack_x, y0 - slack_y, y1 + slack_y};
    }

    MovingTriangle triangle(std::uint32_t triangle, int segment) const {
        MovingTriangle m{};
        for (int k = 0; k < 3; ++k)
            for (int end = 0; end < 2; ++end) {
                const glm::vec3& p = placed_[point(triangle, k, part_.moves ? segment + end : 0)];
                m.x[k][end] = p.x, m.y[k][end] = p.y, m.z[k][end] = p.z;
                m.w[k][end] = perspective_ ? p.z : 1.0f;
            }
        return m;
    }

  private:
    std::size_t point(std::uint32_t triangle, int corner, int knot) const {
        return world_.corners[3 * std::size_t{triangle} + corner] - part_.first_point +
               static_cast<std::size_t>(knot) * part_.vertex_count;
    }

    const WorldMotion& world_;
    const Part& part_;
    bool perspective_;
    std::vector<glm::vec3> placed_;
    std::vector<glm::vec2> seen_;  // x and y over w
    bool simple_ = true;
};

std::size_t most_boxes(const Part& part) {
    return part.triangle_count * static_cast<std::size_t>(part.moves ? part.segments : 1);
}

void bound_part(const Casters& casters, const Part& part, BoxWriter& out) {
    const bool perspective = casters.view.perspective;
    const SeenPoints seen(*casters.world, part, casters.view);
    for (std::uint32_t triangle = part.first_triangle; triangle < part.first_triangle + part.triangle_count;
         ++triangle) {
        const OpacityClass opacity = opacity_class(*casters.frame, triangle);
        if (opacity == OpacityClass::kClear) continue;
        for (int segment = 0; segment < (part.moves ? part.segments : 1); ++segment) {
            ScreenBox box;
            float nearest = 0.0f;
            if (seen.simple()) {
                box = seen.box(triangle, segment, nearest);
            } else {
                const MovingTriangle m = seen.triangle(triangle, segment);
                if (!is_usable(m)) continue;
                const auto [least, most] = std::minmax_element(&m.z[0][0], &m.z[0][0] + 6);
                nearest = nearest_depth(*least, *most);
                box = screen_bounds(m, perspective ? kNearestToLight : 0.5, 1.0);
            }
            out.add(box, perspective, nearest, triangle, segment, opacity == OpacityClass::kMixed);
        }
    }
}

// Ranges of parts write where all before them leave room, and then what they wrote moves together: little memory is
// touched that is not needed. Returns how many there are.
std::size_t write_boxes(const Casters& casters, const std::vector<const Part*>& parts,
                        const std::vector<std::size_t>& first, bool parallel) {
    struct Written {
        std::size_t begin = 0, end = 0;
    };
    std::vector<Written> written(parts.size());
    for_ranges(parallel, parts.size(), [&](std::size_t begin, std::size_t end) {
        // Two ranges do not share a cache line.
        BoxWriter writer(casters.boxes.get(), (first[begin] + Casters::kLanes - 1) / Casters::kLanes * Casters::kLanes);
        for (std::size_t i = begin; i < end; ++i) {
            written[i].begin = writer.next();
            bound_part(casters, *parts[i], writer);
            written[i].end = writer.next();
        }
    });
    BoxWriter together(casters.boxes.get(), 0);
    for (const Written& range : written) {
        if (together.next() == range.begin)
            together = BoxWriter(casters.boxes.get(), range.end);
        else
            for (std::size_t i = range.begin; i < range.end; ++i) together.copy(together, i);
    }
    return together.next();
}

}  // namespace

Casters make_casters(const WorldMotion& world, const Frame& frame, const LightView& view, bool parallel) {
    Casters casters{&world, &frame, view, nullptr, 0, {}, {}};
    std::vector<const Part*> parts;
    std::vector<std::size_t> first{0};  // where each one's boxes may begin
    for (std::size_t i = 0; i < world.parts.size(); ++i) {
        if (is_out_of_view(world.bounds[i], view)) continue;
        parts.push_back(&world.parts[i]);
        first.push_back(first.back() + most_boxes(world.parts[i]) + Casters::kLanes);
    }
    casters.boxes = std::make_unique_for_overwrite<Casters::Boxes[]>(first.back() / Casters::kLanes + 1);
    casters.count = static_cast<std::uint32_t>(write_boxes(casters, parts, first, parallel));
    const std::size_t used = (casters.count + Casters::kLanes - 1) / Casters::kLanes;
    if (casters.count % Casters::kLanes != 0) clear(casters.boxes[used - 1], casters.count % Casters::kLanes);
    casters.groups = groups_of(casters.boxes.get(), used);
    casters.groups_of_groups = groups_of(casters.groups.data(), casters.groups.size());
    return casters;
}

}  // namespace pentaprism
