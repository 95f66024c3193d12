// Twin of none.cpp: keeps everything within the screen bounds.

#include "cull/cull_axis.glsl"

bool none_keeps(LocalTriangle T, Footprint footprint, LocalSample sampled) {
    return true;
}
