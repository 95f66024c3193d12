#include "frame/cut_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

namespace pentaprism {
namespace {

constexpr double kMaxError = 0.4;  // pixels of radius

// Where c of this view is not straight: from the first to the last of these.
std::vector<double> bends(const View& view) {
    const Lens& lens = view.lens;
    std::vector<double> depths;
    if (lens.sharp_range) {
        const auto [from, to] = *lens.sharp_range;
        const double width = 0.25 * (to - from);
        depths = {from - width, from, lens.focus_distance, to, to + width};
    }
    if (std::isfinite(lens.max_foreground_px) && lens.b > 0.0) {
        // -M = a / z + b (perspective) or a + b * z: where the limit takes over.
        const double limit = lens.max_foreground_px;
        depths.push_back(view.perspective ? -lens.a / (lens.b + limit) : (-limit - lens.a) / lens.b);
    }
    std::erase_if(depths, [&](double z) { return !(z > view.depth_near); });
    std::sort(depths.begin(), depths.end());
    return depths;
}

// Of a radius that is drawn straight in c from depth p to depth q, in pixels.
double error(const View& view, double p, double q) {
    const double c0 = view.coc(0, 0, p), c1 = view.coc(0, 0, q);
    double worst = 0.0;
    constexpr int kSteps = 16;
    for (int i = 1; i < kSteps; ++i) {
        const double s = static_cast<double>(i) / kSteps, z = p + s * (q - p);
        worst = std::max(worst, std::abs(c0 + s * (c1 - c0) - view.coc(0, 0, z)) / (view.perspective ? z : 1.0));
    }
    return worst;
}

// How far from depth z, up to `most`, c may be drawn straight.
double straight_from(std::span<const View> views, double z, double most) {
    const auto fits = [&](double step) {
        return std::all_of(views.begin(), views.end(),
                           [&](const View& view) { return error(view, z, z + step) <= kMaxError; });
    };
    if (fits(most)) return most;
    double low = 0.0, high = most;
    for (int i = 0; i < 20; ++i) {
        const double middle = 0.5 * (low + high);
        (fits(middle) ? low : high) = middle;
    }
    return low;
}

class Cutter {
  public:
    Cutter(std::span<const std::uint32_t> indices, std::vector<KnotPoints>& knots) : indices_(indices), knots_(knots) {
        depth_.assign(knots[0].points.size(), 0.0);
        double motion = 0.0;
        for (std::size_t i = 0; i < depth_.size(); ++i) {
            double low = depth_of(knots[0], i), high = low;
            for (const KnotPoints& knot : knots) {
                const double z = depth_of(knot, i);
                depth_[i] += z / static_cast<double>(knots.size());
                low = std::min(low, z), high = std::max(high, z);
            }
            motion = std::max(motion, high - low);
        }
        std::vector<View> views;
        for (const KnotPoints& knot : knots) views.push_back(knot.view);
        levels_ = cut_depths(views, motion);
    }

    CutTriangles cut() {
        for (std::uint32_t i = 0; i < indices_.size() / 3; ++i) cut_triangle(i);
        return std::move(result_);
    }

  private:
    // Of what is left of a triangle: one of its corners, or a cut of one of its edges (edge k begins at corner k).
    struct Vertex {
        std::uint32_t point;
        glm::vec2 place;  // as Piece::corner
        double z;
        int corner, edge;  // one of them is -1
    };
    using Polygon = std::vector<Vertex>;

    static double depth_of(const KnotPoints& knot, std::size_t point) {
        return knot.depths.empty() ? knot.points[point].z : knot.depths[point];
    }

    void cut_triangle(std::uint32_t number) {
        const std::uint32_t* corners = &indices_[3 * std::size_t{number}];
        const Piece whole;
        Polygon rest;
        for (int k = 0; k < 3; ++k) rest.push_back({corners[k], whole.corner[k], depth_[corners[k]], k, -1});
        const auto by_depth = [](const Vertex& a, const Vertex& b) { return a.z < b.z; };
        const auto [nearest, farthest] = std::minmax_element(rest.begin(), rest.end(), by_depth);
        const double last = farthest->z;
        auto level = std::upper_bound(levels_.begin(), levels_.end(), nearest->z);
        for (; level != levels_.end() && *level < last; ++level) {
            Polygon before, after;
            split(rest, corners, static_cast<std::size_t>(level - levels_.begin()), before, after);
            keep(before, number);
            rest = std::move(after);
        }
        keep(rest, number);
    }

    void split(const Polygon& polygon, const std::uint32_t* corners, std::size_t level, Polygon& before,
               Polygon& after) {
        const double z = levels_[level];
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const Vertex &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
            if (a.z <= z) before.push_back(a);
            if (a.z >= z) after.push_back(a);
            if ((a.z < z && b.z > z) || (a.z > z && b.z < z)) {
                // Only the triangle's own edges go on in depth.
                const int edge = a.edge >= 0 ? a.edge : b.edge >= 0 ? b.edge : a.corner;
                const Vertex cut = cut_of(edge, corners, level);
                before.push_back(cut);
                after.push_back(cut);
            }
        }
    }

    void keep(const Polygon& polygon, std::uint32_t number) {
        for (std::size_t i = 2; i < polygon.size(); ++i) {
            Piece piece;
            piece.source = number;
            const Vertex* fan[3] = {&polygon[0], &polygon[i - 1], &polygon[i]};
            for (int k = 0; k < 3; ++k) {
                result_.indices.push_back(fan[k]->point);
                piece.corner[k] = fan[k]->place;
            }
            result_.pieces.push_back(piece);
        }
    }

    // The same numbers whichever triangle asks: the edge's ends are put in order of where they are.
    Vertex cut_of(int edge, const std::uint32_t* corners, std::size_t level) {
        const Piece whole;
        int from = edge, to = (edge + 1) % 3;
        const auto order = [&](int k) {
            const glm::vec4& p = knots_[0].points[corners[k]];
            return std::array{p.x, p.y, p.z};
        };
        if (order(to) < order(from)) std::swap(from, to);
        const std::uint32_t a = corners[from], b = corners[to];
        const double s = (levels_[level] - depth_[a]) / (depth_[b] - depth_[a]);
        const auto [found, is_new] = points_.try_emplace({a, b, level}, 0u);
        if (is_new) found->second = add_point({a, b, s});
        const glm::vec2 place = whole.corner[from] + static_cast<float>(s) * (whole.corner[to] - whole.corner[from]);
        return {found->second, place, levels_[level], -1, edge};
    }

    std::uint32_t add_point(const PointOnEdge& on) {
        const auto point = static_cast<std::uint32_t>(knots_[0].points.size());
        for (KnotPoints& knot : knots_) {
            const glm::dvec4 p(knot.points[on.a]), q(knot.points[on.b]);
            const double z0 = depth_of(knot, on.a), z1 = depth_of(knot, on.b);
            glm::vec4 added(p + on.share * (q - p));
            const auto z = static_cast<float>(z0 + on.share * (z1 - z0));
            added.w = static_cast<float>(knot.view.coc(added.x, added.y, z));
            knot.points.push_back(added);
            if (!knot.depths.empty()) knot.depths.push_back(z);
        }
        result_.cut_points.push_back(on);
        return point;
    }

    std::span<const std::uint32_t> indices_;
    std::vector<KnotPoints>& knots_;
    std::vector<double> depth_;   // of each of the Primitive's vertices, the mean of the knots
    std::vector<double> levels_;  // depths at which edges are cut
    std::map<std::tuple<std::uint32_t, std::uint32_t, std::size_t>, std::uint32_t> points_;
    CutTriangles result_;
};

}  // namespace

std::vector<double> cut_depths(std::span<const View> views, double motion) {
    double first = 1e30, last = -1e30;
    for (const View& view : views)
        if (const std::vector<double> depths = bends(view); !depths.empty()) {
            first = std::min(first, depths.front());
            last = std::max(last, depths.back());
        }
    if (!(first <= last)) return {};
    const double least = last / 500.0, length = last - first;
    motion = std::min(motion, 4.0 * last);  // what moves farther is a corner of something huge
    const double begin = std::max(views[0].depth_near, first - motion), end = last + motion;
    // What stands still may step as far as c is straight; what moves, as far as it is from anywhere.
    double longest = end - begin;
    constexpr int kPlaces = 256;
    for (int i = 0; i < kPlaces && motion > 0.0; ++i) {
        const double z = first + length * (1.5 * i / kPlaces - 0.5);
        if (z >= views[0].depth_near) longest = std::min(longest, straight_from(views, z, std::max(length, least)));
    }
    std::vector<double> depths;
    for (double z = begin; z < end;) {
        depths.push_back(z);
        z += std::max(least, motion > 0.0 ? longest : straight_from(views, z, end - z));
    }
    depths.push_back(end);
    return depths;
}

CutTriangles cut_triangles(std::span<const std::uint32_t> indices, std::vector<KnotPoints>& knots) {
    return Cutter(indices, knots).cut();
}

}  // namespace pentaprism
