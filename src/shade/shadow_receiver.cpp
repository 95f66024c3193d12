#include "shade/shadow_receiver.h"

#include <algorithm>

namespace pentaprism {

void ShadowReceiver::start(const WorldMotion& world, std::uint32_t triangle, const ShadowMap& map) {
    const Part& part = world.part_of(triangle);
    const std::array<std::uint32_t, 3> corners = world.corners(triangle);
    map_ = &map;
    key_ = -1;
    segments_ = part.moves ? part.segments : 1;
    path_ = !part.moves ? Path::kStill : segments_ == 1 ? Path::kStraight : Path::kInPieces;
    const LightView& view = map.view();
    const int knots = part.moves ? segments_ + 1 : 1;
    knots_.resize(9 * static_cast<std::size_t>(knots));
    float* out = knots_.data();
    for (int knot = 0; knot < knots; ++knot)
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t at = corners[k] + knot * part.vertex_count;
            const glm::vec3 p = view.place(world.points[at]);
            for (int axis = 0; axis < 3; ++axis) *out++ = p[axis];
        }
    if (path_ != Path::kInPieces) return;
    knots_stride_ = static_cast<std::size_t>(std::max(knots, kReadable));
    at_knots_.resize(9 * knots_stride_);
    for (int i = 0; i < 9; ++i)
        for (int knot = 0; knot < knots; ++knot) at_knots_[i * knots_stride_ + knot] = knots_[9 * knot + i];
    for (int border = 0; border <= ShadowMap::kSamples; ++border) {
        const float along = static_cast<float>(border * segments_) / ShadowMap::kSamples;
        const int segment = std::min(static_cast<int>(along), segments_ - 1);
        const float s = along - static_cast<float>(segment);
        const float *now = &knots_[9 * segment], *next = now + 9;
        for (int i = 0; i < 9; ++i) at_borders_[i][border] = now[i] + s * (next[i] - now[i]);
    }
}

}  // namespace pentaprism
