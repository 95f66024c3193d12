#pragma once
// Whether the triangles of a tile blur so widely that its samples are better taken by the finer cells of the lens.

#include "cover/cover.h"

namespace pentaprism {

/// False where SampleTable::fine_lens() is empty and for tiles that are not a whole cell. A matter of speed alone: both
/// arrangements hold the same samples.
bool blurs_widely(const TileWork& work);

}  // namespace pentaprism
