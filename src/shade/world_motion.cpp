#include "shade/world_motion.h"

#include <algorithm>
#include <glm/common.hpp>
#include <map>

#include "base/parallel.h"

namespace pentaprism {
namespace {

using Knots = UninitializedVector<glm::dvec3>;  // knot after knot, each of all vertices

// The scene at all knots of all parts; times are exact fractions, so equal times are equal numbers.
class Poses {
  public:
    Poses(const Frame& frame, const std::vector<int>& segments) {
        for (const int n : segments)
            for (int k = 0; k <= n; ++k) poses_[static_cast<double>(k) / n];
        std::vector<std::pair<const double, Pose>*> list;
        for (auto& entry : poses_) list.push_back(&entry);
        parallel_for(list.size(), [&](std::size_t i) {
            list[i]->second = evaluate(*frame.scene, frame.animations, frame.view.shutter.at(list[i]->first));
        });
    }
    const Pose& at(double t) const { return poses_.at(t); }

  private:
    std::map<double, Pose> poses_;
};

// What stands still before a moving camera moves in the world; the camera's path has as many pieces as others need.
int segments_of(const Frame& frame, const Part& part, int most) {
    if (!may_move(*frame.scene, frame.animations, part.placement)) return 0;
    return part.moves ? part.segments : most;
}

Knots pose_knots(const Frame& frame, const Part& part, int segments, const Poses& poses) {
    const std::size_t n = part.vertex_count, of_primitive = n - part.cut_points.size();
    Knots knots((segments + 1) * n);
    for (int k = 0; k <= segments; ++k) {
        const std::span<glm::dvec3> points = std::span(knots).subspan(k * n, n);
        const Pose& pose = segments == 0 ? frame.middle : poses.at(static_cast<double>(k) / segments);
        pose_positions(*frame.scene, pose, part.placement, points.first(of_primitive));
        for (std::size_t i = 0; i < part.cut_points.size(); ++i) {
            const auto [a, b, share] = part.cut_points[i];
            points[of_primitive + i] = points[a] + share * (points[b] - points[a]);
        }
    }
    bool still = true;
    for (int k = 1; still && k <= segments; ++k)
        still = std::equal(knots.begin(), knots.begin() + n, knots.begin() + k * n);
    if (still) knots.resize(n);
    return knots;
}

}  // namespace

WorldMotion world_motion(const Frame& frame, const glm::dvec3& origin, bool frozen) {
    WorldMotion world;
    world.frame = &frame;
    world.origin = origin;
    world.parts = frame.parts;
    int most = 1;
    for (const Part& part : frame.parts) most = std::max(most, part.segments);
    const bool open = !frozen && frame.view.shutter.close > frame.view.shutter.open;
    std::vector<int> segments(frame.parts.size(), 0), needed;
    if (open)
        for (std::size_t i = 0; i < segments.size(); ++i) segments[i] = segments_of(frame, frame.parts[i], most);
    for (const int n : segments)
        if (n > 0) needed.push_back(n);
    const Poses poses(frame, needed);

    std::vector<Knots> knots(segments.size());
    parallel_for(segments.size(),
                 [&](std::size_t i) { knots[i] = pose_knots(frame, frame.parts[i], segments[i], poses); });
    std::size_t points = 0;
    for (std::size_t i = 0; i < segments.size(); ++i) {
        Part& part = world.parts[i];
        part.first_point = static_cast<std::uint32_t>(points);
        part.moves = knots[i].size() > part.vertex_count;
        part.segments = part.moves ? static_cast<int>(knots[i].size() / part.vertex_count) - 1 : 1;
        world.moves = world.moves || part.moves;
        world.at_mid_shutter.push_back(segments[i] == 0);
        world.shifts.push_back(part.first_point - frame.parts[i].first_point);
        points += knots[i].size();
    }
    world.points.resize(points);
    world.bounds.resize(world.parts.size());
    parallel_for(segments.size(), [&](std::size_t i) {
        glm::vec3* out = world.points.data() + world.parts[i].first_point;
        WorldMotion::Bounds bounds;
        for (const glm::dvec3& p : knots[i]) {
            *out = glm::vec3(p - origin);
            bounds.low = glm::min(bounds.low, *out);
            bounds.high = glm::max(bounds.high, *out++);
        }
        world.bounds[i] = bounds;
        knots[i] = {};
    });
    return world;
}

}  // namespace pentaprism
