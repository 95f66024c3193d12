#pragma once
// Material and lights of sixteen points at once: light_point.h by vectors, with the same bits.

#include <cstdint>

#include "base/aligned.h"
#include "shade/batch_texels.h"
#include "shade/light_point.h"
#include "shade/point_batch.h"

namespace pentaprism {

/// LitColor of each point of a batch.
struct LitBatch {
    /// What one light adds. Lanes that are not in `shadowed` hold nothing.
    struct alignas(64) Share {
        PointBatch::Lanes color[3], lift;  ///< lift: of LitColor::Share::offset, as a share of the bulge
        std::uint32_t shadowed = 0;        ///< bit of each lane that asks for a shadow
    };
    alignas(64) PointBatch::Lanes rest[3], smooth[3];  ///< smooth: unit normal, towards the eye
    AlignedVector<Share> shares;                       ///< of each light of the scene

    void get(const PointBatch& batch, int lane, LitColor& out) const;
};

/// For the CPU target in use when it is made (base/cpu.h); the same bits on all. Keeps its memory.
class LightPoints {
  public:
    LightPoints();

    /// Of a material without layers (BoundMaterial::layered). Keeps the memory of `out`. A lane depends on its own
    /// point alone.
    void light(const ShadingScene& scene, const PointBatch& batch, LitBatch& out);

    using LightLanes = void (*)(const ShadingScene&, const PointBatch&, const BatchTexels&, LitBatch&);

  private:
    LightLanes light_lanes_;
    BatchTexels texels_;
};

}  // namespace pentaprism
