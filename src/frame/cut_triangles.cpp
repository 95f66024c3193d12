#include "frame/cut_triangles.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace pentaprism {
namespace {

constexpr double kMaxError = 0.5;  // pixels of radius
constexpr std::uint32_t kWhole = 0xffffffffu;

float depth_of(const KnotPoints& knot, std::uint32_t point) {
    return knot.depths.empty() ? knot.points[point].z : knot.depths[point];
}

// Depths at which Lens::coc() bends.
std::vector<double> bends(const Lens& lens) {
    std::vector<double> depths{lens.focus_distance};
    if (lens.sharp_range) {
        const auto [from, to] = *lens.sharp_range;
        const double width = 0.25 * (to - from);
        depths.insert(depths.end(), {from - width, from - 0.5 * width, from, to, to + 0.5 * width, to + width});
    }
    if (std::isfinite(lens.max_foreground_px)) depths.push_back(-lens.a / (lens.b + lens.max_foreground_px));
    return depths;
}

class Cutter {
  public:
    Cutter(std::span<const std::uint32_t> indices, std::vector<KnotPoints>& knots) : indices_(indices), knots_(knots) {
        for (const KnotPoints& knot : knots_) bends_.push_back(bends(knot.view.lens));
    }

    CutTriangles cut() {
        for (std::uint32_t i = 0; i < indices_.size() / 3; ++i) {
            const std::array corners = {indices_[3 * i], indices_[3 * i + 1], indices_[3 * i + 2]};
            Piece piece;
            piece.source = i;
            open_.push_back({corners, piece});
            const bool seen = may_be_seen(corners);
            while (!open_.empty()) {
                const Open next = open_.back();
                open_.pop_back();
                if (!seen || !split(next)) keep(next);
            }
        }
        return std::move(result_);
    }

  private:
    struct Open {
        std::array<std::uint32_t, 3> corners;
        Piece piece;
    };

    void keep(const Open& triangle) {
        result_.indices.insert(result_.indices.end(), triangle.corners.begin(), triangle.corners.end());
        result_.pieces.push_back(triangle.piece);
    }

    // False: no edge needs a cut.
    bool split(const Open& t) {
        std::uint32_t middle[3];  // of the edge from corner k
        for (int k = 0; k < 3; ++k) middle[k] = middle_of(t.corners[k], t.corners[(k + 1) % 3]);
        const int cuts = static_cast<int>(3 - std::count(middle, middle + 3, kWhole));
        if (cuts == 0) return false;
        const auto corner = [&](int k) { return std::pair(t.corners[k % 3], t.piece.corner[k % 3]); };
        const auto edge = [&](int k) {
            return std::pair(middle[k % 3], 0.5f * (t.piece.corner[k % 3] + t.piece.corner[(k + 1) % 3]));
        };
        const auto add = [&](const auto& a, const auto& b, const auto& c) {
            open_.push_back({{a.first, b.first, c.first}, {t.piece.source, {a.second, b.second, c.second}}});
        };
        if (cuts == 3) {
            for (int k = 0; k < 3; ++k) add(corner(k), edge(k), edge(k + 2));
            add(edge(0), edge(1), edge(2));
            return true;
        }
        int k = 0;  // one cut: that edge; two: the edge that stays
        while ((middle[k] == kWhole) == (cuts == 1)) ++k;
        if (cuts == 1) {
            add(corner(k), edge(k), corner(k + 2));
            add(edge(k), corner(k + 1), corner(k + 2));
        } else {
            add(corner(k), corner(k + 1), edge(k + 1));
            add(corner(k), edge(k + 1), edge(k + 2));
            add(edge(k + 1), corner(k + 2), edge(k + 2));
        }
        return true;
    }

    // The point in the middle of an edge that needs a cut, else kWhole.
    std::uint32_t middle_of(std::uint32_t a, std::uint32_t b) {
        const std::uint64_t key = (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
        const auto [found, is_new] = middles_.try_emplace(key, kWhole);
        if (is_new && needs_cut(a, b)) found->second = add_middle(a, b);
        return found->second;
    }

    std::uint32_t add_middle(std::uint32_t a, std::uint32_t b) {
        const auto point = static_cast<std::uint32_t>(knots_[0].points.size());
        for (KnotPoints& knot : knots_) {
            const glm::dvec4 middle = 0.5 * (glm::dvec4(knot.points[a]) + glm::dvec4(knot.points[b]));
            const auto z = static_cast<float>(0.5 * (double{depth_of(knot, a)} + depth_of(knot, b)));
            glm::vec4 p(middle);
            p.w = static_cast<float>(knot.view.coc(p.x, p.y, z));
            knot.points.push_back(p);
            if (!knot.depths.empty()) knot.depths.push_back(z);
        }
        result_.midpoints.push_back({a, b});
        return point;
    }

    // The same for (b, a), and for an edge of another triangle that lies at the same place: ends in order of their
    // numbers.
    bool needs_cut(std::uint32_t a, std::uint32_t b) const {
        const auto order = [&](std::uint32_t i) {
            const glm::vec4& p = knots_[0].points[i];
            return std::array{p.x, p.y, p.z};
        };
        if (order(b) < order(a)) std::swap(a, b);
        for (std::size_t k = 0; k < knots_.size(); ++k)
            if (error(knots_[k], bends_[k], a, b) > kMaxError) return true;
        return false;
    }

    // Of the radius along the edge, in pixels, where it lies in front of the camera.
    static double error(const KnotPoints& knot, const std::vector<double>& bends, std::uint32_t a, std::uint32_t b) {
        const View& view = knot.view;
        const glm::dvec4 p(knot.points[a]), q(knot.points[b]);
        const double z0 = depth_of(knot, a), z1 = depth_of(knot, b);
        double worst = 0.0;
        const auto look_at = [&](double s) {
            const glm::dvec4 m = p + s * (q - p);
            const double z = z0 + s * (z1 - z0);
            if (z >= view.depth_near && m.z >= view.w_near())
                worst = std::max(worst, std::abs(m.w - view.coc(m.x, m.y, z)) / m.z);
        };
        for (const double s : {0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875}) look_at(s);
        for (const double z : bends)
            if ((z0 < z) != (z1 < z)) look_at((z - z0) / (z1 - z0));
        return worst;
    }

    // False only for a triangle that is out of the picture at all times: radii do not fall with depth, so those of the
    // corners are the largest.
    bool may_be_seen(const std::array<std::uint32_t, 3>& corners) const {
        constexpr double kMargin = 2.0;
        double x0 = 1e30, x1 = -1e30, y0 = 1e30, y1 = -1e30, radius = kMargin;
        for (const KnotPoints& knot : knots_)
            for (const std::uint32_t i : corners) {
                const glm::dvec4 p(knot.points[i]);
                if (!(p.z >= knot.view.w_near())) return true;
                x0 = std::min(x0, p.x / p.z), x1 = std::max(x1, p.x / p.z);
                y0 = std::min(y0, p.y / p.z), y1 = std::max(y1, p.y / p.z);
                radius = std::max(radius, std::abs(p.w) / p.z + kMargin);
            }
        const View& view = knots_[0].view;
        const double half_width = 0.5 * view.width + radius;
        const double half_height = 0.5 * view.height + radius * std::max(1.0, view.lens.ratio);
        return x0 <= half_width && x1 >= -half_width && y0 <= half_height && y1 >= -half_height;
    }

    std::span<const std::uint32_t> indices_;
    std::vector<KnotPoints>& knots_;
    std::vector<std::vector<double>> bends_;
    std::unordered_map<std::uint64_t, std::uint32_t> middles_;
    std::vector<Open> open_;
    CutTriangles result_;
};

}  // namespace

CutTriangles cut_triangles(std::span<const std::uint32_t> indices, std::vector<KnotPoints>& knots) {
    return Cutter(indices, knots).cut();
}

}  // namespace pentaprism
