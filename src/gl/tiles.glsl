// What the compute shaders share: triangles are bounded and counted in tiles of 8x8 pixels, entered into the tiles' lists, and
// each tile looks at its own. Lists are in no order: the nearest of each sample, and of equals the first, is so by comparison.

#include "bound/local_triangle.glsl"

const int kTile = 8;
const int kCellTiles = kCellSize / kTile;
const uint kTilePixels = uint(kTile * kTile);

// One motion segment of (some of) a part's triangles. As gl/tile_pass.cpp writes it.
struct Draw {
    uint first_item;      // of its batch
    uint first_triangle;  // of the frame
    uint first_of_part;
    uint part;
    uint open, close;  // how far the points of both ends are from those of knot 0
    uint two_sided;
    uint segment, segments;
};

layout(std430, binding = 1) restrict readonly buffer Points { vec4 points[]; };  // x, y, w, c
layout(std430, binding = 2) restrict readonly buffer Corners { uint corners[]; };
layout(std430, binding = 3) restrict readonly buffer Depths { float depths[]; };  // orthographic cameras only
layout(std430, binding = 4) restrict readonly buffer Draws { Draw draws[]; };

uniform ivec4 region;  // x0, x1, y0, y1: pixels
uniform ivec2 first_tile;
uniform ivec2 tiles;   // columns, rows
uniform bool with_depths;

// Which thing of many this invocation is for; there are at most 65535 groups in a row.
uint item_index() {
    return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
}

MovingTriangle moving_triangle(Draw d, uint triangle) {
    MovingTriangle m;
    for (int i = 0; i < 3; ++i) {
        uint corner = corners[3u * triangle + uint(i)];
        m.q[i] = points[corner + d.open];
        m.r[i] = points[corner + d.close];
        m.z_q[i] = with_depths ? depths[corner + d.open] : m.q[i].z;
        m.z_r[i] = with_depths ? depths[corner + d.close] : m.r[i].z;
    }
    return m;
}

// A record: triangle, draw, x0 | x1 << 16, y0 | y1 << 16.
uvec4 record_of(uint triangle, uint draw, ivec4 pixels) {
    uvec4 p = uvec4(pixels);
    return uvec4(triangle, draw, p.x | p.y << 16, p.z | p.w << 16);
}
ivec4 pixels_of(uvec4 record) {
    return ivec4(record.z & 0xffffu, record.z >> 16, record.w & 0xffffu, record.w >> 16);
}

// The tiles of a rectangle of pixels: x0, x1, y0, y1, half open, counted from the first.
ivec4 tiles_of(ivec4 pixels) {
    ivec4 last = pixels - ivec4(0, 1, 0, 1);
    return last / kTile - first_tile.xxyy + ivec4(0, 1, 0, 1);
}
