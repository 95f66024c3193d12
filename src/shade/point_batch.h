#pragma once
// Sixteen points of surfaces of one material, of any triangles: what light_points.h lights at once.

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "shade/shading_scene.h"
#include "shade/surface_point.h"

namespace pentaprism {

/// Lane by lane as SurfacePoint; lanes from `count` on hold what they held before.
struct PointBatch {
    static constexpr int kLanes = 16;
    using Lanes = float[kLanes];

    const BoundMaterial* material = nullptr;
    int count = 0;
    alignas(64) Lanes position[3] = {}, normal[3] = {}, tangent[4] = {}, face[3] = {}, color[3] = {};
    alignas(64) Lanes uv[2][2] = {}, footprint[2][3] = {};  // [set][u, v], [set][uu, uv, vv]
    alignas(64) Lanes bulge = {};
    alignas(64) Lanes side = {};         ///< 1: the front, -1: the back
    alignas(64) Lanes has_tangent = {};  ///< 1 or 0

    void set(int lane, const SurfacePoint& point) {
        for (int k = 0; k < 3; ++k) {
            position[k][lane] = point.position[k];
            normal[k][lane] = point.normal[k];
            face[k][lane] = point.face[k];
            color[k][lane] = point.color[k];
        }
        for (int k = 0; k < 4; ++k) tangent[k][lane] = point.tangent[k];
        for (int set = 0; set < 2; ++set) {
            for (int k = 0; k < 2; ++k) uv[set][k][lane] = point.uv[set][k];
            const TextureFootprint& from = point.footprint[set];
            footprint[set][0][lane] = from.uu, footprint[set][1][lane] = from.uv, footprint[set][2][lane] = from.vv;
        }
        bulge[lane] = point.bulge;
        side[lane] = point.front ? 1.0f : -1.0f;
        has_tangent[lane] = point.has_tangent ? 1.0f : 0.0f;
    }

    SurfacePoint get(int lane) const {
        SurfacePoint point;
        for (int k = 0; k < 3; ++k) {
            point.position[k] = position[k][lane];
            point.normal[k] = normal[k][lane];
            point.face[k] = face[k][lane];
            point.color[k] = color[k][lane];
        }
        for (int k = 0; k < 4; ++k) point.tangent[k] = tangent[k][lane];
        for (int set = 0; set < 2; ++set) {
            for (int k = 0; k < 2; ++k) point.uv[set][k] = uv[set][k][lane];
            point.footprint[set] = {footprint[set][0][lane], footprint[set][1][lane], footprint[set][2][lane]};
        }
        point.bulge = bulge[lane];
        point.front = side[lane] > 0.0f;
        point.has_tangent = has_tangent[lane] > 0.0f;
        return point;
    }
};

}  // namespace pentaprism
