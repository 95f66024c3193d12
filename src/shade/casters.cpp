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
constexpr double kNear = 1e-3;  // metres before a perspective light

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
    const glm::dvec3 middle = 0.5 * (low + high) - view.position, half = 0.5 * (high - low);
    const auto least = [&](const glm::dvec3& n) { return glm::dot(n, middle) - glm::dot(glm::abs(n), half); };
    const glm::dvec3 forward = view.axes[2], side = static_cast<double>(kWidestTangent) * forward;
    if (least(-forward) > -kNear) return true;
    for (int axis = 0; axis < 2; ++axis)
        if (least(view.axes[axis] - side) > 0.0 || least(-view.axes[axis] - side) > 0.0) return true;
    return false;
}

// The parts in view, numbered anew.
Frame place_parts(const WorldMotion& world, const Frame& frame, const LightView& view, int width,
                  std::vector<std::uint32_t>& taken) {
    Frame out;
    out.scene = frame.scene;
    out.textures = frame.textures;
    out.view.width = out.view.height = width;
    out.view.perspective = view.perspective;
    out.view.shutter = frame.view.shutter;
    out.view.depth_near = view.perspective ? kNear : -1e30;
    out.view.depth_far = 1e30;
    std::uint32_t points = 0, triangles = 0;
    for (std::uint32_t i = 0; i < world.parts.size(); ++i) {
        if (is_out_of_view(world.bounds[i], view)) continue;
        taken.push_back(i);
        Part& part = out.parts.emplace_back(world.parts[i]);
        part.two_sided = true;  // a shadow does not ask for the side
        part.first_point = points;
        part.first_triangle = triangles;
        points += part.vertex_count * static_cast<std::uint32_t>(part.moves ? part.segments + 1 : 1);
        triangles += part.triangle_count;
    }
    out.points.resize(points);
    if (!view.perspective) out.depths.resize(points);
    out.corners.resize(3 * std::size_t{triangles});
    out.part_of.resize(triangles);
    if (!frame.pieces.empty()) out.pieces.resize(triangles);
    return out;
}

void fill_part(const WorldMotion& world, const Frame& frame, const Part& was, const LightView& view,
               std::uint32_t number, Frame& out) {
    const Part& part = out.parts[number];
    const std::size_t points = part.vertex_count * static_cast<std::size_t>(part.moves ? part.segments + 1 : 1);
    for (std::size_t i = 0; i < points; ++i) {
        const glm::dvec3 p = glm::dvec3(world.points[was.first_point + i]) - view.position;
        const glm::vec3 seen(glm::dot(p, view.axes[0]), glm::dot(p, view.axes[1]), glm::dot(p, view.axes[2]));
        out.points[part.first_point + i] = glm::vec4(seen.x, seen.y, view.perspective ? seen.z : 1.0f, 0.0f);
        if (!view.perspective) out.depths[part.first_point + i] = seen.z;
    }
    const std::uint32_t* corner = &world.corners[3 * std::size_t{was.first_triangle}];
    std::uint32_t* to = &out.corners[3 * std::size_t{part.first_triangle}];
    for (std::size_t i = 0; i < 3 * std::size_t{part.triangle_count}; ++i)
        to[i] = corner[i] - was.first_point + part.first_point;
    std::fill_n(out.part_of.begin() + part.first_triangle, part.triangle_count, number);
    if (!frame.pieces.empty())
        std::copy_n(frame.pieces.begin() + was.first_triangle, part.triangle_count,
                    out.pieces.begin() + part.first_triangle);
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

// Writes the box if something of it is in view. Returns where the next one goes.
Casters::Box* take(const ScreenBox& box, bool perspective, Casters::Box like, Casters::Box* out) {
    if (box.empty()) return out;
    if (perspective &&
        (box.x0 > kWidestTangent || box.x1 < -kWidestTangent || box.y0 > kWidestTangent || box.y1 < -kWidestTangent))
        return out;
    like.x0 = next_below(static_cast<float>(box.x0)), like.x1 = next_above(static_cast<float>(box.x1));
    like.y0 = next_below(static_cast<float>(box.y0)), like.y1 = next_above(static_cast<float>(box.y1));
    *out = like;
    return out + 1;
}

// A little before the nearest of the triangle's depths, as rounding may put a sample there.
float nearest_depth(float nearest, float farthest) {
    constexpr float kMargin = 32.0f / 16777216.0f;
    return nearest - kMargin * std::max(std::abs(nearest), std::abs(farthest));
}

// Points of a part on the light's picture, for boxes of triangles that are wholly before the light: with the lens
// closed a moving triangle lies between its six ends as they are seen. A box of its own for each triangle, as
// screen_bounds() makes it, costs five times as much.
class SeenPoints {
  public:
    SeenPoints(const Frame& frame, const Part& part) : frame_(frame), part_(part) {
        const std::size_t count = part.vertex_count * static_cast<std::size_t>(part.moves ? part.segments + 1 : 1);
        seen_.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            const glm::vec4& p = frame.points[part.first_point + i];
            const float inverse = 1.0f / p.z;
            const float depth = frame.view.perspective ? p.z : frame.depths[part.first_point + i];
            seen_[i] = {p.x * inverse, p.y * inverse, p.z, depth};
            simple_ = simple_ && p.z >= kNear && std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest &&
                      std::abs(depth) <= kLargest;
        }
    }
    /// Whether box() may be asked.
    bool simple() const { return simple_; }

    ScreenBox box(std::uint32_t triangle, int segment, float& nearest_depth_of_it) const {
        float least = INFINITY, most = -INFINITY, x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY,
              nearest = INFINITY, farthest = 0.0f;
        for (int k = 0; k < 3; ++k) {
            std::size_t at = frame_.corners[3 * std::size_t{triangle} + k] - part_.first_point +
                             static_cast<std::size_t>(segment) * part_.vertex_count;
            for (int end = 0; end < (part_.moves ? 2 : 1); ++end, at += part_.vertex_count) {
                const glm::vec4& p = seen_[at];
                x0 = std::min(x0, p.x), x1 = std::max(x1, p.x);
                y0 = std::min(y0, p.y), y1 = std::max(y1, p.y);
                nearest = std::min(nearest, p.z), farthest = std::max(farthest, p.z);
                least = std::min(least, p.w), most = std::max(most, p.w);
            }
        }
        nearest_depth_of_it = nearest_depth(least, most);
        // As in screen_bounds(), where |x| <= w * reach; a quarter more for the divisions here.
        constexpr float kUnitRoundoff = 1.0f / 16777216.0f;
        const float slack = 20.0f * kUnitRoundoff * farthest / nearest;
        const float slack_x = slack * (32.0f + 2.0f * std::max(std::abs(x0), std::abs(x1)));
        const float slack_y = slack * (32.0f + 2.0f * std::max(std::abs(y0), std::abs(y1)));
        return {x0 - slack_x, x1 + slack_x, y0 - slack_y, y1 + slack_y, nearest - 2.0f * kUnitRoundoff * farthest};
    }

  private:
    const Frame& frame_;
    const Part& part_;
    std::vector<glm::vec4> seen_;  // x, y; w, depth
    bool simple_ = true;
};

std::size_t most_boxes(const Part& part) {
    return part.triangle_count * static_cast<std::size_t>(part.moves ? part.segments : 1);
}

// Writes the part's boxes. Returns the end of them.
Casters::Box* bound_part(const Frame& frame, const Part& part, Casters::Box* out) {
    const SeenPoints seen(frame, part);
    const bool perspective = frame.view.perspective;
    for (std::uint32_t triangle = part.first_triangle; triangle < part.first_triangle + part.triangle_count;
         ++triangle) {
        const OpacityClass opacity = opacity_class(frame, triangle);
        if (opacity == OpacityClass::kClear) continue;
        for (int segment = 0; segment < (part.moves ? part.segments : 1); ++segment) {
            Casters::Box box{
                0, 0, 0, 0, 0, triangle, static_cast<std::uint16_t>(segment), opacity == OpacityClass::kMixed};
            if (seen.simple()) {
                out = take(seen.box(triangle, segment, box.nearest), perspective, box, out);
                continue;
            }
            const MovingTriangle m = moving_triangle(frame, triangle, segment);
            if (!is_usable(m)) continue;
            const auto [least, most] = std::minmax_element(&m.z[0][0], &m.z[0][0] + 6);
            box.nearest = nearest_depth(*least, *most);
            out = take(screen_bounds(m, frame.view.w_near(), 1.0), perspective, box, out);
        }
    }
    return out;
}

}  // namespace

Casters make_casters(const WorldMotion& world, const Frame& frame, const LightView& view, int width, bool parallel) {
    Casters casters;
    std::vector<std::uint32_t> taken;
    casters.frame = place_parts(world, frame, view, width, taken);
    Frame& seen = casters.frame;
    // Each range of parts writes where all before it leave room, and then they move together: little memory is touched
    // that is not needed.
    std::vector<std::size_t> first(taken.size() + 1);
    for (std::size_t i = 0; i < taken.size(); ++i) first[i + 1] = first[i] + most_boxes(seen.parts[i]);
    casters.room = std::make_unique_for_overwrite<Casters::Box[]>(first.back());
    std::vector<std::span<Casters::Box>> written(taken.size());
    for_ranges(parallel, taken.size(), [&](std::size_t begin, std::size_t end) {
        Casters::Box* to = casters.room.get() + first[begin];
        for (std::size_t i = begin; i < end; ++i) {
            fill_part(world, frame, world.parts[taken[i]], view, static_cast<std::uint32_t>(i), seen);
            written[i] = {to, bound_part(seen, seen.parts[i], to)};
            to = written[i].data() + written[i].size();
        }
    });
    Casters::Box* last = casters.room.get();
    for (const std::span<Casters::Box> boxes : written)
        last = boxes.data() == last ? last + boxes.size() : std::copy(boxes.begin(), boxes.end(), last);
    casters.boxes = {casters.room.get(), last};
    for (const Casters::Box& box : casters.boxes)
        casters.extent =
            std::max({casters.extent, std::abs(box.x0), std::abs(box.x1), std::abs(box.y0), std::abs(box.y1)});
    return casters;
}

}  // namespace pentaprism
