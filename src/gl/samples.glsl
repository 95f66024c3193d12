// Where a sample is kept in buffers, and what is kept there. The order is that of Hits (cover/hits.h), cell by cell of the
// region and with as many slots as a pass has: ((cell * 64 + block) * slots + slot) * 16 + lane.

#include "gl/sample_bits.glsl"

uniform ivec2 region_cell;       // of the region's top left pixel
uniform int region_cell_columns;
uniform int pass_slots;

int entry_of(ivec2 pixel, int slot) {
    ivec2 cell = pixel / kCellSize - region_cell, place = pixel % kCellSize;
    int block = place.y / kBlockSize * kCellBlocks + place.x / kBlockSize;
    int lane = place.y % kBlockSize * kBlockSize + place.x % kBlockSize;
    int in_region = cell.y * region_cell_columns + cell.x;
    return ((in_region * kCellBlocks * kCellBlocks + block) * pass_slots + slot) * (kBlockSize * kBlockSize) + lane;
}
