#include "frame/frame.h"

#include <algorithm>

#include "base/parallel.h"
#include "frame/cut_triangles.h"
#include "frame/moments.h"
#include "frame/vertex_paths.h"

namespace pentaprism {
namespace {

// What one placement contributes before its place in the frame is known.
struct PosedPart {
    Part part;
    KnotVertices knots;
    CutTriangles cut;  // empty: all triangles are whole
};

// As if the corners 1 and 2 of the whole triangle and of the piece had changed their names.
void mirror(Piece& piece) {
    std::swap(piece.corner[1], piece.corner[2]);
    for (glm::vec2& corner : piece.corner) std::swap(corner.x, corner.y);
}

// Cuts the triangles of a part that is posed.
void cut_part(const Primitive& primitive, Moments& moments, PosedPart& posed) {
    Part& part = posed.part;
    const std::size_t n = part.vertex_count, knots = part.moves ? part.segments + 1 : 1;
    std::vector<KnotPoints> cut(knots);
    auto& [points, depths] = posed.knots;
    for (std::size_t k = 0; k < knots; ++k) {
        cut[k].view = moments.at(part.moves ? static_cast<double>(k) / part.segments : 0.0).view;
        cut[k].points.assign(points.begin() + k * n, points.begin() + (k + 1) * n);
        if (!depths.empty()) cut[k].depths.assign(depths.begin() + k * n, depths.begin() + (k + 1) * n);
    }
    posed.cut = cut_triangles(primitive.indices, cut);
    part.cut_points = std::move(posed.cut.cut_points);
    part.vertex_count = static_cast<std::uint32_t>(cut[0].points.size());
    part.triangle_count = static_cast<std::uint32_t>(posed.cut.pieces.size());
    points.clear();
    depths.clear();
    for (const KnotPoints& knot : cut) {
        points.insert(points.end(), knot.points.begin(), knot.points.end());
        depths.insert(depths.end(), knot.depths.begin(), knot.depths.end());
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

    if (part.vertex_count > 0) {
        VertexPaths paths(scene, view, placement, moments);
        part.moves = shutter_open && !paths.stand_still();
        if (part.moves && settings.motion_segments == 0) {
            part.segments = paths.straight_pieces(posed.knots);
        } else {
            if (part.moves) part.segments = settings.motion_segments;
            paths.at_knots(part.moves ? part.segments : 0, posed.knots);
        }
    }
    if (!view.lens.pinhole() && !view.lens.straight()) cut_part(primitive, moments, posed);
    return posed;
}

constexpr std::size_t kAtOnce = 1 << 14;  // points or triangles that one thread copies: a part may be all of the frame

// Copies part `number` to its place in the frame.
void put_part(const PosedPart& posed, std::uint32_t number, Frame& frame) {
    const Part& part = frame.parts[number];
    const KnotVertices& knots = posed.knots;
    parallel_ranges(knots.points.size(), kAtOnce, [&](std::size_t begin, std::size_t end) {
        const std::size_t to = part.first_point + begin;
        std::copy(knots.points.begin() + begin, knots.points.begin() + end, frame.points.begin() + to);
        if (!knots.depths.empty())
            std::copy(knots.depths.begin() + begin, knots.depths.begin() + end, frame.depths.begin() + to);
    });
    const CutTriangles& cut = posed.cut;
    const bool is_cut = !cut.pieces.empty();
    const Primitive& primitive = frame.scene->meshes[part.placement.mesh].primitives[part.placement.primitive];
    const std::vector<std::uint32_t>& indices = is_cut ? cut.indices : primitive.indices;
    parallel_ranges(part.triangle_count, kAtOnce, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const std::size_t triangle = part.first_triangle + t;
            std::uint32_t* corner = &frame.corners[3 * triangle];
            for (int k = 0; k < 3; ++k) corner[k] = part.first_point + indices[3 * t + k];
            if (part.mirrored) std::swap(corner[1], corner[2]);
            frame.part_of[triangle] = number;
            if (!is_cut) continue;
            frame.pieces[triangle] = cut.pieces[t];
            if (part.mirrored) mirror(frame.pieces[triangle]);
        }
    });
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
        points += p.knots.points.size();
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
        put_part(posed[i], static_cast<std::uint32_t>(i), frame);
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
