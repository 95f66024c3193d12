#pragma once
// Which casters may be seen in a cell of a shadow map.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "shade/casters.h"

namespace pentaprism {

/// A rectangle of a light's view and a limit of depth.
struct CasterQuery {
    float x0, x1, y0, y1;
    int limit;
};

/// Writes the numbers of the boxes that touch the rectangle and begin before the limit, ascending, into `out`, which
/// grows as it must and keeps its size. Returns how many they are. Thread-safe; the same on every CPU target.
using FindCasters = std::size_t (*)(const Casters& casters, const CasterQuery& query, std::vector<std::uint32_t>& out);
FindCasters find_casters();

}  // namespace pentaprism
