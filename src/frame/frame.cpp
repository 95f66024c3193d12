#include "frame/frame.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "base/parallel.h"
#include "frame/cut_triangles.h"

namespace pentaprism {
namespace {

constexpr double kMaxError = 0.1;  // pixels between the true path and its straight segments
constexpr int kMaxSegments = 64;

// The scene and the camera at one shutter time.
struct Moment {
    Pose pose;
    glm::dmat4 to_camera;
    View view;
};

// Moments by shutter time, made when first asked for. Times are multiples of 1/128, exact in double.
class Moments {
  public:
    Moments(const Scene& scene, const View& view, std::span<const Index> animations)
        : scene_(scene), view_(view), animations_(animations) {}

    const Moment& at(double t) {
        const std::lock_guard<std::mutex> lock(mutex_);
        auto& moment = moments_[t];
        if (!moment) {
            moment = std::make_unique<Moment>();
            moment->pose = evaluate(scene_, animations_, view_.shutter.at(t));
            moment->to_camera = world_to_camera(view_, moment->pose);
            moment->view = view_at(scene_, view_, moment->pose);
        }
        return *moment;
    }

  private:
    const Scene& scene_;
    const View& view_;
    std::span<const Index> animations_;
    std::mutex mutex_;
    std::map<double, std::unique_ptr<Moment>> moments_;
};

// One vertex.
struct ClipPoint {
    glm::dvec4 p;  // x, y, w, z
    double c;
    bool operator==(const ClipPoint&) const = default;
};
using ClipPoints = std::vector<ClipPoint>;

ClipPoints clip_points(const Scene& scene, const Placement& placement, const Moment& moment) {
    std::vector<glm::dvec3> positions(scene.meshes[placement.mesh].primitives[placement.primitive].positions.size());
    pose_positions(scene, moment.pose, placement, positions);
    ClipPoints points(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const glm::dvec4 p = to_raster_clip(moment.view, glm::dvec3(moment.to_camera * glm::dvec4(positions[i], 1.0)));
        points[i] = {p, moment.view.coc(p.x, p.y, p.w)};
    }
    return points;
}

// Largest distance in pixels between `truth` and the point at fraction s of the straight segment from p to q, over the
// vertices that are in front of the camera and not far outside the picture. Where circles of confusion do not follow
// from depth alone, also between their radii.
double path_error(const View& view, const ClipPoints& p, const ClipPoints& q, const ClipPoints& truth, double s) {
    const double reach = 2.0 * std::max(view.width, view.height), near = view.w_near();
    const bool blur_bends = !view.has_straight_sight();
    double worst = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const glm::dvec4 &true_p = truth[i].p, straight = p[i].p + s * (q[i].p - p[i].p);
        if (!(true_p.z >= near && straight.z >= near)) continue;
        const double x = true_p.x / true_p.z, y = true_p.y / true_p.z;
        if (!(std::abs(x) < reach && std::abs(y) < reach)) continue;
        const double dx = straight.x / straight.z - x, dy = straight.y / straight.z - y;
        worst = std::max(worst, dx * dx + dy * dy);
        if (!blur_bends) continue;
        const double dr = (p[i].c + s * (q[i].c - p[i].c)) / straight.z - truth[i].c / true_p.z;
        worst = std::max(worst, dr * dr);
    }
    return std::sqrt(worst);
}

// A placement's points at the knots of its segments.
class Path {
  public:
    Path(const Scene& scene, const View& view, const Placement& placement, Moments& moments)
        : scene_(scene), view_(view), placement_(placement), moments_(moments) {}

    const ClipPoints& at(double t) {
        auto& points = points_[t];
        if (points.empty()) points = clip_points(scene_, placement_, moments_.at(t));
        return points;
    }

    bool stands_still() {
        return at(0.0) == at(0.25) && at(0.0) == at(0.5) && at(0.0) == at(0.75) && at(0.0) == at(1.0);
    }

    // Errors are asked at the quarters of each segment: at the middle alone, an S-shaped path would look straight.
    bool is_straight_with(int segments) {
        for (int k = 0; k < segments; ++k)
            for (const double s : {0.25, 0.5, 0.75}) {
                const double t0 = double(k) / segments, t1 = double(k + 1) / segments;
                if (path_error(view_, at(t0), at(t1), at((k + s) / segments), s) > kMaxError) return false;
            }
        return true;
    }

  private:
    const Scene& scene_;
    const View& view_;
    Placement placement_;
    Moments& moments_;
    std::map<double, ClipPoints> points_;
};

int choose_segments(Path& path) {
    int segments = 1;
    while (segments < kMaxSegments && !path.is_straight_with(segments)) segments *= 2;
    return segments;
}

// What one placement contributes before its place in the frame is known.
struct PosedPart {
    Part part;
    std::vector<glm::vec4> points;
    std::vector<float> depths;
    CutTriangles cut;  // empty: all triangles are whole
};

// As if the corners 1 and 2 of the whole triangle and of the piece had changed their names.
void mirror(Piece& piece) {
    std::swap(piece.corner[1], piece.corner[2]);
    for (glm::vec2& corner : piece.corner) std::swap(corner.x, corner.y);
}

void append_knot(const View& view, const ClipPoints& knot, PosedPart& posed) {
    // All knots at once: growing copies.
    const std::size_t all = knot.size() * (posed.part.moves ? posed.part.segments + 1 : 1);
    posed.points.reserve(all);
    if (!view.perspective) posed.depths.reserve(all);
    for (const auto& [p, c] : knot) {
        posed.points.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z),
                                  static_cast<float>(c));
        if (!view.perspective) posed.depths.push_back(static_cast<float>(p.w));
    }
}

// Cuts the triangles of a part that is posed.
void cut_part(const Primitive& primitive, Moments& moments, PosedPart& posed) {
    Part& part = posed.part;
    const std::size_t n = part.vertex_count, knots = part.moves ? part.segments + 1 : 1;
    std::vector<KnotPoints> cut(knots);
    for (std::size_t k = 0; k < knots; ++k) {
        cut[k].view = moments.at(part.moves ? static_cast<double>(k) / part.segments : 0.0).view;
        cut[k].points.assign(posed.points.begin() + k * n, posed.points.begin() + (k + 1) * n);
        if (!posed.depths.empty())
            cut[k].depths.assign(posed.depths.begin() + k * n, posed.depths.begin() + (k + 1) * n);
    }
    posed.cut = cut_triangles(primitive.indices, cut);
    part.cut_points = std::move(posed.cut.cut_points);
    part.vertex_count = static_cast<std::uint32_t>(cut[0].points.size());
    part.triangle_count = static_cast<std::uint32_t>(posed.cut.pieces.size());
    posed.points.clear();
    posed.depths.clear();
    for (const KnotPoints& knot : cut) {
        posed.points.insert(posed.points.end(), knot.points.begin(), knot.points.end());
        posed.depths.insert(posed.depths.end(), knot.depths.begin(), knot.depths.end());
    }
}

PosedPart pose_part(const Scene& scene, const View& view, const Placement& placement, const Pose& middle,
                    Moments& moments, bool shutter_open, const ShutterSettings& settings) {
    const Primitive& primitive = scene.meshes[placement.mesh].primitives[placement.primitive];
    PosedPart posed;
    Part& part = posed.part;
    part.placement = placement;
    part.triangle_count = static_cast<std::uint32_t>(primitive.indices.size() / 3);
    part.vertex_count = static_cast<std::uint32_t>(primitive.positions.size());
    part.mirrored = is_mirrored(scene, middle, placement);
    part.material = primitive.material;
    const Material material = primitive.material == kNone ? Material{} : scene.materials[primitive.material];
    part.two_sided = material.double_sided;
    // Glass is opaque at some samples only, as what is blended.
    const bool glass = material.transmission > 0.0f && material.alpha_mode == AlphaMode::kOpaque;
    part.alpha_mode = glass ? AlphaMode::kBlend : material.alpha_mode;

    Path path(scene, view, placement, moments);
    part.moves = shutter_open && part.vertex_count > 0 && !path.stands_still();
    if (part.moves) part.segments = settings.motion_segments > 0 ? settings.motion_segments : choose_segments(path);
    for (int k = 0; k <= (part.moves ? part.segments : 0); ++k)
        append_knot(view, path.at(double(k) / part.segments), posed);
    if (!view.lens.pinhole() && !view.lens.straight()) cut_part(primitive, moments, posed);
    return posed;
}

}  // namespace

std::array<std::uint32_t, 3> Frame::vertices(std::uint32_t triangle) const {
    const Part& part = parts[part_of[triangle]];
    if (pieces.empty()) {
        const std::uint32_t* corner = &corners[3 * std::size_t{triangle}];
        return {corner[0] - part.first_point, corner[1] - part.first_point, corner[2] - part.first_point};
    }
    const Primitive& primitive = scene->meshes[part.placement.mesh].primitives[part.placement.primitive];
    const std::uint32_t* index = &primitive.indices[3 * std::size_t{pieces[triangle].source}];
    if (part.mirrored) return {index[0], index[2], index[1]};
    return {index[0], index[1], index[2]};
}

std::uint32_t Frame::source(std::uint32_t triangle) const {
    return pieces.empty() ? triangle - parts[part_of[triangle]].first_triangle : pieces[triangle].source;
}

glm::vec3 Frame::in_source(std::uint32_t triangle, const glm::vec3& b) const {
    if (pieces.empty()) return b;
    const glm::vec2* corner = pieces[triangle].corner;
    const glm::vec2 p = b.x * corner[0] + b.y * corner[1] + b.z * corner[2];
    return {1.0f - p.x - p.y, p.x, p.y};
}

Frame pose_frame(const Scene& scene, const View& view, std::span<const Index> animations,
                 const ShutterSettings& settings) {
    Frame frame;
    frame.scene = &scene;
    frame.view = view;
    frame.animations.assign(animations.begin(), animations.end());
    Moments moments(scene, view, animations);
    frame.middle = moments.at(0.5).pose;
    const bool shutter_open = view.shutter.close > view.shutter.open;

    const std::vector<Placement> placed = placements(scene);
    std::vector<PosedPart> posed(placed.size());
    parallel_for(placed.size(), [&](std::size_t i) {
        posed[i] = pose_part(scene, view, placed[i], frame.middle, moments, shutter_open, settings);
    });

    std::size_t points = 0, triangles = 0;
    for (PosedPart& p : posed) {
        p.part.first_point = static_cast<std::uint32_t>(points);
        p.part.first_triangle = static_cast<std::uint32_t>(triangles);
        points += p.points.size();
        triangles += p.part.triangle_count;
    }
    frame.points.resize(points);
    if (!view.perspective) frame.depths.resize(points);
    frame.corners.resize(3 * triangles);
    frame.part_of.resize(triangles);
    if (std::any_of(posed.begin(), posed.end(), [](const PosedPart& p) { return !p.cut.pieces.empty(); }))
        frame.pieces.resize(triangles);
    frame.parts.reserve(posed.size());
    for (const PosedPart& p : posed) frame.parts.push_back(p.part);

    parallel_for(posed.size(), [&](std::size_t i) {
        const Part& part = frame.parts[i];
        std::copy(posed[i].points.begin(), posed[i].points.end(), frame.points.begin() + part.first_point);
        std::copy(posed[i].depths.begin(), posed[i].depths.end(),
                  frame.depths.begin() + (view.perspective ? 0 : part.first_point));
        const bool is_cut = !posed[i].cut.pieces.empty();
        const auto& indices = is_cut ? posed[i].cut.indices
                                     : scene.meshes[part.placement.mesh].primitives[part.placement.primitive].indices;
        if (is_cut)
            std::copy(posed[i].cut.pieces.begin(), posed[i].cut.pieces.end(),
                      frame.pieces.begin() + part.first_triangle);
        for (std::uint32_t t = 0; t < part.triangle_count; ++t) {
            std::uint32_t* corner = &frame.corners[3 * std::size_t{part.first_triangle + t}];
            for (int k = 0; k < 3; ++k) corner[k] = part.first_point + indices[3 * std::size_t{t} + k];
            if (part.mirrored) {
                std::swap(corner[1], corner[2]);
                if (is_cut) mirror(frame.pieces[part.first_triangle + t]);
            }
            frame.part_of[part.first_triangle + t] = static_cast<std::uint32_t>(i);
        }
        posed[i] = {};
    });
    return frame;
}

MovingTriangle moving_triangle(const Frame& frame, std::uint32_t triangle, int segment) {
    const Part& part = frame.parts[frame.part_of[triangle]];
    MovingTriangle m;
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end) {
            const std::size_t knot = part.moves ? static_cast<std::size_t>(segment) + end : 0;
            const std::size_t p = frame.corners[3 * std::size_t{triangle} + i] + knot * part.vertex_count;
            const glm::vec4& point = frame.points[p];
            m.x[i][end] = point.x;
            m.y[i][end] = point.y;
            m.w[i][end] = point.z;
            m.c[i][end] = point.w;
            m.z[i][end] = frame.view.perspective ? point.z : frame.depths[p];
        }
    return m;
}

}  // namespace pentaprism
