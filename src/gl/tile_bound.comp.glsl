// First of three: which triangles may be seen, in which pixels, and how many are in each tile.

layout(local_size_x = 64) in;

#include "gl/bound.glsl"
#include "gl/tiles.glsl"

uniform uint items, first_draw, draw_count;  // of the batch

layout(std430, binding = 5) restrict writeonly buffer Records { uvec4 records[]; };
layout(std430, binding = 6) restrict buffer Counts { uint counts[]; };  // of each tile; at the end, of records

// The draw that the item is of.
uint draw_of(uint item) {
    uint low = first_draw, high = first_draw + draw_count;
    while (high - low > 1u) {
        uint middle = (low + high) / 2u;
        if (draws[middle].first_item <= item)
            low = middle;
        else
            high = middle;
    }
    return low;
}

void main() {
    uint item = item_index();
    if (item >= items) return;
    uint draw = draw_of(item);
    Draw d = draws[draw];
    uint triangle = d.first_triangle + (item - d.first_item);
    ivec4 pixels;
    vec4 box;
    if (!bound_triangle(moving_triangle(d, triangle), surface_of(int(d.part)), triangle - d.first_of_part,
                        d.two_sided != 0u, region, pixels, box))
        return;
    records[atomicAdd(counts[tiles.x * tiles.y], 1u)] = record_of(triangle, draw, pixels);
    ivec4 t = tiles_of(pixels);
    for (int y = t.z; y < t.w; ++y)
        for (int x = t.x; x < t.y; ++x) atomicAdd(counts[y * tiles.x + x], 1u);
}
