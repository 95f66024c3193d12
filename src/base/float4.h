#pragma once
// Four floats that are added and multiplied at once, on any target (SSE2, NEON: part of every build). Each operation is
// rounded by itself: the same bits everywhere.

namespace pentaprism {

typedef float Float4 __attribute__((vector_size(16)));

inline Float4 splat(float x) {
    return Float4{x, x, x, x};
}

}  // namespace pentaprism
