#pragma once
// Vertices in raster clip space, a block at a time, in double: what posing computes for every vertex at several times
// of the shutter. Small enough that the blocks of a motion segment stay in the first-level cache.

#include <cstddef>
#include <glm/mat4x4.hpp>

#include "camera/view.h"

namespace pentaprism {

/// All kernels below compute whole blocks: entries that stand for no vertex repeat one that does.
struct PointBlock {
    static constexpr std::size_t kSize = 128;
    alignas(64) double x[kSize], y[kSize], z[kSize];
};

/// As camera/view.h has it; z: depth.
struct ClipBlock {
    alignas(64) double x[PointBlock::kSize], y[PointBlock::kSize], w[PointBlock::kSize], z[PointBlock::kSize],
        c[PointBlock::kSize];
};

struct ClipKernels {
    /// matrix * point.
    void (*transform)(const glm::dmat4& matrix, const PointBlock& points, PointBlock& out);

    /// World space to raster clip space, with circles of confusion.
    void (*to_clip)(const View& view, const glm::dmat4& to_camera, const PointBlock& world, ClipBlock& out);

    bool (*is_equal)(const ClipBlock& a, const ClipBlock& b);

    /// Largest distance in pixels between `truth` and the point at fraction s of the straight segment from p to q, over
    /// the vertices that are in front of the camera and not far outside the picture. Where circles of confusion do not
    /// follow from depth alone, also between their radii.
    double (*path_error)(const View& view, const ClipBlock& p, const ClipBlock& q, const ClipBlock& truth, double s);
};

/// Of cpu_isa().
ClipKernels clip_kernels();

}  // namespace pentaprism
