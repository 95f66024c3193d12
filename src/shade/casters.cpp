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
#include "shade/bound_casters.h"

namespace pentaprism {
namespace {

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
            usable = usable && std::abs(v) <= kLargestOfCasters;
    return usable;
}

constexpr std::uint8_t kNothing = 0xff;  // no limit has this number

void clear(Casters::Extents& extents, std::size_t first) {
    for (std::size_t lane = first; lane < Casters::kLanes; ++lane) {
        extents.x0[lane] = extents.y0[lane] = INFINITY;
        extents.x1[lane] = extents.y1[lane] = -INFINITY;
        extents.limit[lane] = kNothing;
    }
}

// Where boxes are written, one after the other. A block ends early where the next triangle's number is too far off.
class BoxWriter {
  public:
    BoxWriter(Casters::Boxes* boxes, std::size_t first) : boxes_(boxes), next_(first) {}
    std::size_t next() const { return next_; }

    /// If something of the rectangle is in view.
    void add(const CasterBatch& batch, int in_batch, const LightView& view, const CasterBounds& bounds) {
        const float x0 = bounds.x0[in_batch], x1 = bounds.x1[in_batch], y0 = bounds.y0[in_batch],
                    y1 = bounds.y1[in_batch];
        if (view.perspective &&
            (x0 > kWidestTangent || x1 < -kWidestTangent || y0 > kWidestTangent || y1 < -kWidestTangent))
            return;
        Casters::Boxes& out = block_for(batch.triangle[in_batch], batch.mixed[in_batch]);
        const std::size_t lane = next_++ % Casters::kLanes;
        out.x0[lane] = x0, out.x1[lane] = x1, out.y0[lane] = y0, out.y1[lane] = y1;
        out.limit[lane] = static_cast<std::uint8_t>(view.perspective ? limit_of(bounds.nearest[in_batch], true) : 0);
        out.segment[lane] = static_cast<std::uint8_t>(batch.segment[in_batch]);
    }

    /// The boxes of the lanes [begin, end), which lie farther on, once more.
    void copy(std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end;) {
            // It may be the one that is written.
            const Casters::Boxes in = boxes_[i / Casters::kLanes];
            const std::size_t last = std::min(end, (i / Casters::kLanes + 1) * Casters::kLanes);
            for (; i < last; ++i) {
                const std::size_t was = i % Casters::kLanes;
                if (in.limit[was] == kNothing) continue;
                Casters::Boxes& out = block_for(in.triangle(was), in.is_mixed(was));
                const std::size_t lane = next_++ % Casters::kLanes;
                out.x0[lane] = in.x0[was], out.x1[lane] = in.x1[was];
                out.y0[lane] = in.y0[was], out.y1[lane] = in.y1[was];
                out.limit[lane] = in.limit[was], out.segment[lane] = in.segment[was];
            }
        }
    }

    /// Leaves nothing in the rest of the block.
    void close() {
        const std::size_t first = next_ % Casters::kLanes;
        if (first == 0) return;
        Casters::Boxes& block = boxes_[next_ / Casters::kLanes];
        clear(block, first);
        std::fill(block.beyond_first + first, block.beyond_first + Casters::kLanes, std::uint8_t{0});
        std::fill(block.segment + first, block.segment + Casters::kLanes, std::uint8_t{0});
        next_ += Casters::kLanes - first;
    }

  private:
    // The block of the next lane, in which triangle and opacity are written already.
    Casters::Boxes& block_for(std::uint32_t triangle, bool mixed) {
        if (next_ % Casters::kLanes != 0 &&
            triangle - boxes_[next_ / Casters::kLanes].first_triangle >= Casters::Boxes::kSpan)
            close();
        Casters::Boxes& block = boxes_[next_ / Casters::kLanes];
        const std::size_t lane = next_ % Casters::kLanes;
        if (lane == 0) block.first_triangle = triangle, block.mixed = 0;
        block.beyond_first[lane] = static_cast<std::uint8_t>(triangle - block.first_triangle);
        block.mixed = static_cast<std::uint16_t>(block.mixed | (mixed ? 1u : 0u) << lane);
        return block;
    }

    Casters::Boxes* boxes_;
    std::size_t next_;
};

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

MovingTriangle moving_caster(const WorldMotion& world, const LightView& view, std::uint32_t triangle, int segment) {
    const Part& part = world.part_of(triangle);
    const std::array<std::uint32_t, 3> corners = world.corners(triangle);
    MovingTriangle m{};
    for (int k = 0; k < 3; ++k)
        for (int end = 0; end < 2; ++end) {
            const std::size_t knot = part.moves ? static_cast<std::size_t>(segment + end) : 0;
            const std::size_t at = corners[k] + knot * part.vertex_count;
            const glm::vec3 p = view.place(world.points[at]);
            m.x[k][end] = p.x, m.y[k][end] = p.y, m.z[k][end] = p.z;
            m.w[k][end] = view.perspective ? p.z : 1.0f;
        }
    return m;
}

// One that may reach behind the light. False if nothing of it is seen.
bool bound_any(const MovingTriangle& m, bool perspective, int lane, CasterBounds& out) {
    if (!is_usable(m)) return false;
    const ScreenBox box = screen_bounds(m, perspective ? kNearestToLight : 0.5, 1.0);
    if (box.empty()) return false;
    out.x0[lane] = next_below(static_cast<float>(box.x0)), out.x1[lane] = next_above(static_cast<float>(box.x1));
    out.y0[lane] = next_below(static_cast<float>(box.y0)), out.y1[lane] = next_above(static_cast<float>(box.y1));
    const auto [least, most] = std::minmax_element(&m.z[0][0], &m.z[0][0] + 6);
    out.nearest[lane] = *least - kDepthRounding * std::max(std::abs(*least), std::abs(*most));
    return true;
}

void write_batch(const Casters& casters, const Part& part, CasterBatch& batch, BoxWriter& out) {
    const BoundCasters bound = bound_casters();
    CasterBounds bounds;
    const std::uint32_t bounded = bound(*casters.world, part, casters.view, batch, bounds);
    for (int lane = 0; lane < batch.count; ++lane) {
        const bool known = (bounded >> lane & 1u) != 0;
        if (known || bound_any(moving_caster(*casters.world, casters.view, batch.triangle[lane], batch.segment[lane]),
                               casters.view.perspective, lane, bounds))
            out.add(batch, lane, casters.view, bounds);
    }
    batch.count = 0;
}

// Triangles of a part that one thread bounds.
struct PartRange {
    const Part* part;
    std::uint32_t begin, end;
    std::size_t most_boxes() const {
        return (end - begin) * static_cast<std::size_t>(part->moves ? part->segments : 1);
    }
};
constexpr std::uint32_t kTrianglesAtOnce = 4096;

void bound_range(const Casters& casters, const PartRange& range, BoxWriter& out) {
    const Part& part = *range.part;
    CasterBatch batch;
    for (std::uint32_t triangle = range.begin; triangle < range.end; ++triangle) {
        const OpacityClass opacity = opacity_class(*casters.world->frame, triangle);
        if (opacity == OpacityClass::kClear) continue;
        for (int segment = 0; segment < (part.moves ? part.segments : 1); ++segment) {
            batch.triangle[batch.count] = triangle;
            batch.segment[batch.count] = static_cast<std::uint16_t>(segment);
            batch.mixed[batch.count] = opacity == OpacityClass::kMixed;
            if (++batch.count == CasterBatch::kLanes) write_batch(casters, part, batch, out);
        }
    }
    if (batch.count > 0) write_batch(casters, part, batch, out);
}

// Each range writes where all before it leave room, and then what they wrote moves together: little memory is
// touched that is not needed: the same blocks as if one had written all. Returns how many lanes there are.
std::size_t write_boxes(const Casters& casters, const std::vector<PartRange>& ranges,
                        const std::vector<std::size_t>& first, bool parallel) {
    struct Written {
        std::size_t begin = 0, end = 0;
    };
    std::vector<Written> written(ranges.size());
    for_ranges(parallel, ranges.size(), [&](std::size_t begin, std::size_t end) {
        // Two threads do not share a block. There is room for those that end early: numbers that are left out between
        // two triangles have theirs, and between two ranges there are kLanes more.
        BoxWriter writer(casters.boxes.get(), (first[begin] + Casters::kLanes - 1) / Casters::kLanes * Casters::kLanes);
        for (std::size_t i = begin; i < end; ++i) {
            written[i].begin = writer.next();
            bound_range(casters, ranges[i], writer);
            written[i].end = writer.next();
        }
    });
    BoxWriter together(casters.boxes.get(), 0);
    for (const Written& range : written) {
        if (together.next() == range.begin)
            together = BoxWriter(casters.boxes.get(), range.end);
        else
            together.copy(range.begin, range.end);
    }
    together.close();
    return together.next();
}

}  // namespace

Casters make_casters(const WorldMotion& world, const LightView& view, bool parallel) {
    Casters casters{&world, view, nullptr, 0, {}, {}};
    std::vector<PartRange> ranges;
    std::vector<std::size_t> first{0};  // where each one's boxes may begin
    for (std::size_t i = 0; i < world.parts.size(); ++i) {
        if (is_out_of_view(world.bounds[i], view)) continue;
        const Part& part = world.parts[i];
        const std::uint32_t last = part.first_triangle + part.triangle_count;
        for (std::uint32_t begin = part.first_triangle; begin < last; begin += kTrianglesAtOnce) {
            ranges.push_back({&part, begin, std::min(last, begin + kTrianglesAtOnce)});
            first.push_back(first.back() + ranges.back().most_boxes() + Casters::kLanes);
        }
    }
    casters.boxes = std::make_unique_for_overwrite<Casters::Boxes[]>(first.back() / Casters::kLanes + 1);
    casters.count = static_cast<std::uint32_t>(write_boxes(casters, ranges, first, parallel));
    casters.groups = groups_of(casters.boxes.get(), casters.count / Casters::kLanes);
    casters.groups_of_groups = groups_of(casters.groups.data(), casters.groups.size());
    return casters;
}

}  // namespace pentaprism
