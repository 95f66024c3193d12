// Second of three: the records of each tile, one list after the other. Where each begins, the processor has summed up.

layout(local_size_x = 64) in;

#include "gl/tiles.glsl"

uniform uint record_count;
uniform ivec2 some_tiles;  // those whose lists are made: from, to

layout(std430, binding = 5) restrict readonly buffer Records { uvec4 records[]; };
layout(std430, binding = 6) restrict buffer Next { uint next[]; };  // where the tile's next entry goes
layout(std430, binding = 7) restrict writeonly buffer Entries { uint entries[]; };

void main() {
    uint index = item_index();
    if (index >= record_count) return;
    ivec4 t = tiles_of(pixels_of(records[index]));
    for (int y = t.z; y < t.w; ++y)
        for (int x = t.x; x < t.y; ++x) {
            int tile = y * tiles.x + x;
            if (tile >= some_tiles.x && tile < some_tiles.y) entries[atomicAdd(next[tile], 1u)] = index;
        }
}
