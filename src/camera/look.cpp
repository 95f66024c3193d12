#include "camera/look.h"

#include <algorithm>

namespace pentaprism {
namespace {

bool is_below(const Scene& scene, Index node, Index ancestor) {
    for (; node != kNone; node = scene.nodes[node].parent)
        if (node == ancestor) return true;
    return false;
}

}  // namespace

Index find_node(const Scene& scene, const std::string& name) {
    for (Index n = 0; n < static_cast<Index>(scene.nodes.size()); ++n)
        if (scene.nodes[n].name == name) return n;
    return kNone;
}

Box3 bounding_box(const Scene& scene, const Pose& pose, Index node) {
    Box3 box;
    std::vector<glm::dvec3> positions;
    for (const Placement& placement : placements(scene)) {
        if (node != kNone && !is_below(scene, placement.node, node)) continue;
        positions.resize(scene.meshes[placement.mesh].primitives[placement.primitive].positions.size());
        pose_positions(scene, pose, placement, positions);
        for (const glm::dvec3& p : positions) box.extend({p, p});
    }
    return box;
}

double depth_at_pixel(const Scene& scene, const Pose& pose, const View& view, double x, double y) {
    const double gx = x - 0.5 * view.width, gy = 0.5 * view.height - y;
    const glm::dmat4 to_camera = world_to_camera(view, pose);
    double nearest = std::numeric_limits<double>::infinity();
    std::vector<glm::dvec3> positions;
    std::vector<glm::dvec4> clip;
    for (const Placement& placement : placements(scene)) {
        const Primitive& primitive = scene.meshes[placement.mesh].primitives[placement.primitive];
        positions.resize(primitive.positions.size());
        clip.resize(positions.size());
        pose_positions(scene, pose, placement, positions);
        for (std::size_t i = 0; i < positions.size(); ++i)
            clip[i] = to_raster_clip(view, glm::dvec3(to_camera * glm::dvec4(positions[i], 1.0)));
        for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
            const glm::dvec4 p[3] = {clip[primitive.indices[i]], clip[primitive.indices[i + 1]],
                                     clip[primitive.indices[i + 2]]};
            double e[3], dx[3], dy[3];
            for (int k = 0; k < 3; ++k) {
                dx[k] = p[k].x - gx * p[k].z;
                dy[k] = p[k].y - gy * p[k].z;
            }
            for (int k = 0; k < 3; ++k) e[k] = dx[(k + 1) % 3] * dy[(k + 2) % 3] - dx[(k + 2) % 3] * dy[(k + 1) % 3];
            if (!((e[0] >= 0 && e[1] >= 0 && e[2] >= 0) || (e[0] <= 0 && e[1] <= 0 && e[2] <= 0))) continue;
            const double sum = e[0] + e[1] + e[2];
            const double depth = (e[0] * p[0].w + e[1] * p[1].w + e[2] * p[2].w) / sum;
            if (sum != 0.0 && depth >= view.depth_near && depth <= view.depth_far) nearest = std::min(nearest, depth);
        }
    }
    return nearest;
}

}  // namespace pentaprism
