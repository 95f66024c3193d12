// Coverage: homogeneous edge functions (Olano & Greer 1997) with the tie rule and condition (N) of
// docs/develop/algorithms.md 2.1 and 2.3. Departs from cover/ in everything but the formula: double precision, no
// cells.

#include "peer/brute_force.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "bound/local_triangle.h"
#include "cover/exact.h"
#include "frame/opacity.h"

namespace pentaprism {
namespace {

// Above this a coordinate is no longer trusted and the triangle is dropped, as the renderer does (frame/frame.h).
constexpr double kLargest = 1e12;

/// Where the sample's time falls among the knots of a part.
struct Moment {
    int segment = 0;
    double s = 0;  // in [0, 1)
};

Moment moment(const Part& part, double t) {
    const double scaled = t * part.segments;  // exact: 24 bits times a small integer
    const int segment = std::min(static_cast<int>(scaled), part.segments - 1);
    return {segment, scaled - segment};
}

/// A vertex seen by the sample: (x, y) relative to the sample's ray, times w.
struct Seen {
    double x, y, w, z;
};

double mix(float q, float r, double s) {
    return q + s * (static_cast<double>(r) - q);
}

/// The three vertices of a triangle between two knots.
struct Corners {
    const glm::vec4 *begin[3], *end[3];
    float z_begin[3], z_end[3];
};

Corners corners_of(const Frame& frame, const Part& part, std::uint32_t triangle, int segment) {
    Corners corners;
    const std::size_t stride = part.moves ? part.vertex_count : 0;
    for (int i = 0; i < 3; ++i) {
        const std::size_t begin = frame.corners[3 * std::size_t{triangle} + i] + stride * segment;
        const std::size_t end = begin + stride;
        corners.begin[i] = &frame.points[begin];
        corners.end[i] = &frame.points[end];
        corners.z_begin[i] = frame.view.perspective ? frame.points[begin].z : frame.depths[begin];
        corners.z_end[i] = frame.view.perspective ? frame.points[end].z : frame.depths[end];
    }
    return corners;
}

bool can_be_trusted(const Corners& corners) {
    for (int i = 0; i < 3; ++i) {
        for (const glm::vec4* p : {corners.begin[i], corners.end[i]}) {
            for (int k = 0; k < 4; ++k) {
                if (!(std::abs((*p)[k]) <= kLargest)) return false;
            }
        }
        if (!(std::abs(corners.z_begin[i]) <= kLargest) || !(std::abs(corners.z_end[i]) <= kLargest)) return false;
    }
    return true;
}

/// Points hold x, y, w, c in glm's x, y, z, w.
Seen see(const Corners& corners, int i, double s, const PlacedSample& sample) {
    const glm::vec4 &q = *corners.begin[i], &r = *corners.end[i];
    const double w = mix(q.z, r.z, s), c = mix(q.w, r.w, s);
    return {mix(q.x, r.x, s) + sample.u * c - sample.gx * w, mix(q.y, r.y, s) + sample.v * c - sample.gy * w, w,
            mix(corners.z_begin[i], corners.z_end[i], s)};
}

bool spans_zero(double a, double b, double c) {
    return std::min({a, b, c}) <= 0.0 && std::max({a, b, c}) >= 0.0;  // false for NaN
}

/// Sign of an edge function; on the edge itself as if the sample lay at (gx + h, gy + h^2), h -> 0+.
int edge_sign(double e, const Seen& i, const Seen& j) {
    if (e != 0.0) return e > 0.0 ? 1 : -1;
    const double by_y = j.w * i.y - i.w * j.y;
    if (by_y != 0.0) return by_y > 0.0 ? 1 : -1;
    const double by_x = i.w * j.x - j.w * i.x;
    return by_x > 0.0 ? 1 : (by_x < 0.0 ? -1 : 0);
}

/// Depth range of the camera, in the floats that the frame's triangles carry.
double near_of(const View& view) {
    return static_cast<float>(view.depth_near);
}
double far_of(const View& view) {
    return static_cast<float>(view.depth_far);
}

ExactHit cover(const Frame& frame, const Part& part, std::uint32_t triangle, const Moment& at,
               const PlacedSample& sample) {
    const Corners corners = corners_of(frame, part, triangle, at.segment);
    const std::array<Seen, 3> v{see(corners, 0, at.s, sample), see(corners, 1, at.s, sample),
                                see(corners, 2, at.s, sample)};
    if (!spans_zero(v[0].x, v[1].x, v[2].x) || !spans_zero(v[0].y, v[1].y, v[2].y)) return {};  // (N)

    double e[3];
    int sign[3];
    for (int k = 0; k < 3; ++k) {
        const Seen &i = v[(k + 1) % 3], &j = v[(k + 2) % 3];
        e[k] = i.x * j.y - j.x * i.y;
        sign[k] = edge_sign(e[k], i, j);
    }
    if (sign[0] == 0 || sign[0] != sign[1] || sign[1] != sign[2]) return {};
    if (!part.two_sided && sign[0] < 0) return {};
    const double sum = e[0] + e[1] + e[2];
    if (sum == 0.0 || !can_be_trusted(corners)) return {};

    const double depth = std::clamp((e[0] * v[0].z + e[1] * v[1].z + e[2] * v[2].z) / sum,
                                    std::min({v[0].z, v[1].z, v[2].z}), std::max({v[0].z, v[1].z, v[2].z}));
    if (!(depth >= near_of(frame.view) && depth <= far_of(frame.view))) return {};
    return {triangle, depth, {e[0] / sum, e[1] / sum, e[2] / sum}, sign[0] > 0};
}

/// Keeps the nearer of two hits; the lower triangle where depths are equal.
void keep_nearer(ExactHit& nearest, const ExactHit& hit) {
    if (hit.depth < nearest.depth || (hit.depth == nearest.depth && hit.triangle < nearest.triangle)) nearest = hit;
}

bool may_win(const ExactHit& nearest, const ExactHit& hit) {
    return hit.hit() && !(hit.depth > nearest.depth);
}

// --- the outline of a triangle ---------------------------------------------------------------------------------------

struct Polygon {
    std::array<Seen, 8> vertex;
    int count = 0;
    void add(const Seen& v) { vertex[count++] = v; }
};

/// Sutherland & Hodgman 1974: the part of the polygon with side(v) >= 0, `side` affine.
template <class Side>
Polygon clip(const Polygon& polygon, Side side) {
    Polygon out;
    for (int i = 0; i < polygon.count; ++i) {
        const Seen &a = polygon.vertex[i], &b = polygon.vertex[(i + 1) % polygon.count];
        const double da = side(a), db = side(b);
        if (da >= 0.0) out.add(a);
        if ((da >= 0.0) != (db >= 0.0)) {
            const double s = da / (da - db);
            out.add({std::lerp(a.x, b.x, s), std::lerp(a.y, b.y, s), std::lerp(a.w, b.w, s), std::lerp(a.z, b.z, s)});
        }
    }
    return out;
}

/// Distance from the origin to the segment a b.
double distance_to_segment(double ax, double ay, double bx, double by) {
    const double dx = bx - ax, dy = by - ay;
    const double length2 = dx * dx + dy * dy;
    const double s = length2 > 0.0 ? std::clamp(-(ax * dx + ay * dy) / length2, 0.0, 1.0) : 0.0;
    return std::hypot(ax + s * dx, ay + s * dy);
}

}  // namespace

PlacedSample place_sample(const View& view, const SamplePoint& point, int px, int py, int index,
                          const OpacityPattern& pattern) {
    PlacedSample sample{point, px, py, index, pattern};
    sample.gx = px + static_cast<double>(point.x) - 0.5 * view.width;
    sample.gy = 0.5 * view.height - (py + static_cast<double>(point.y));
    sample.u = point.u;
    sample.v = point.v;
    sample.t = point.t;
    return sample;
}

PlacedSample place_sample(const View& view, const SampleTable& table, int px, int py, int index) {
    return place_sample(view, table.sample(px, py, index), px, py, index, table);
}

ExactHit cover_in_double(const Frame& frame, std::uint32_t triangle, const PlacedSample& sample) {
    const Part& part = frame.parts[frame.part_of[triangle]];
    return cover(frame, part, triangle, moment(part, sample.t), sample);
}

bool is_opaque(const Frame& frame, std::uint32_t triangle, const PlacedSample& sample) {
    const Part& part = frame.parts[frame.part_of[triangle]];
    if (part.alpha_mode == AlphaMode::kOpaque) return true;
    const CellCentre centre = cell_centre(frame.view, sample.px / kCellSize, sample.py / kCellSize);
    const LocalTriangle local = localize(frame, triangle, moment(part, sample.t).segment, centre);
    const SampleHit hit = project_sample(local, local_sample(sample.point, sample.px, sample.py));
    return is_opaque_at(frame, triangle, hit.barycentrics, sample.px, sample.py, sample.index, sample.pattern);
}

ExactHit nearest_in_double(const Frame& frame, const std::vector<std::uint32_t>& candidates,
                           const PlacedSample& sample) {
    ExactHit nearest;
    for (const std::uint32_t triangle : candidates) {
        const ExactHit hit = cover_in_double(frame, triangle, sample);
        if (may_win(nearest, hit) && is_opaque(frame, triangle, sample)) keep_nearer(nearest, hit);
    }
    return nearest;
}

ExactHit nearest_in_double(const Frame& frame, const PlacedSample& sample) {
    ExactHit nearest;
    for (const Part& part : frame.parts) {
        const Moment at = moment(part, sample.t);
        for (std::uint32_t i = 0; i < part.triangle_count; ++i) {
            const ExactHit hit = cover(frame, part, part.first_triangle + i, at, sample);
            if (may_win(nearest, hit) && is_opaque(frame, hit.triangle, sample)) keep_nearer(nearest, hit);
        }
    }
    return nearest;
}

double distance_to_outline(const Frame& frame, std::uint32_t triangle, const PlacedSample& sample) {
    const Part& part = frame.parts[frame.part_of[triangle]];
    const Moment at = moment(part, sample.t);
    const Corners corners = corners_of(frame, part, triangle, at.segment);
    Polygon polygon;
    for (int i = 0; i < 3; ++i) polygon.add(see(corners, i, at.s, sample));
    const double z_near = near_of(frame.view), z_far = far_of(frame.view);
    polygon = clip(polygon, [&](const Seen& v) { return v.z - z_near; });
    polygon = clip(polygon, [&](const Seen& v) { return z_far - v.z; });

    double nearest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < polygon.count; ++i) {
        const Seen &a = polygon.vertex[i], &b = polygon.vertex[(i + 1) % polygon.count];
        nearest = std::min(nearest, distance_to_segment(a.x / a.w, a.y / a.w, b.x / b.w, b.y / b.w));
    }
    return nearest;
}

std::vector<ExactHit> render_brute_force(const Frame& frame, const SampleTable& table) {
    const View& view = frame.view;
    const int spp = table.spp();
    std::vector<ExactHit> hits(static_cast<std::size_t>(view.width) * view.height * spp);
    parallel_for(static_cast<std::size_t>(view.width) * view.height, [&](std::size_t pixel) {
        const int px = static_cast<int>(pixel) % view.width, py = static_cast<int>(pixel) / view.width;
        for (int index = 0; index < spp; ++index) {
            hits[pixel * spp + index] = nearest_in_double(frame, place_sample(view, table, px, py, index));
        }
    });
    return hits;
}

}  // namespace pentaprism
