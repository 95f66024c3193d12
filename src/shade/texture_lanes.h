#pragma once
// BoundTexture::sample() of sixteen points at once, with the same bits.

#include "shade/point_batch.h"

namespace pentaprism {

struct TextureLanes {
    using Lanes = PointBatch::Lanes;
    const BoundTexture* texture;  ///< has a pyramid
    const PointBatch* batch;
    int first_channel, channels;  ///< of R, G, B, A; at most 4
    Lanes* out;                   ///< [channel - first_channel]; on cache lines; lanes from the batch's count on stay
};

/// For the CPU target in use (base/cpu.h); the same bits on all.
using SampleTextureLanes = void (*)(const TextureLanes& work);
SampleTextureLanes sample_texture_lanes();

}  // namespace pentaprism
