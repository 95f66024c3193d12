// Twin of bbox.cpp: the geometry shader has emitted the fifteen-edge box, so nothing is left to ask.

#include "cull/cull_axis.glsl"

bool bbox_keeps(LocalTriangle T, Footprint footprint, LocalSample sampled) {
    return true;
}
