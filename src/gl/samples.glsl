// Where a sample is kept in buffers, and what is kept there. The order is that of Hits (cover/hits.h), cell by cell of the
// region and with as many slots as a pass has: ((cell * 64 + block) * slots + slot) * 16 + lane.

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

// Bits of u; bits of v; t in 24 bits and the low 8 bits of the sample's index in its pixel; the place in 256ths of a pixel
// from the cell's left and bottom side, 14 bits each, and the high 4 bits of the index.
LocalSample unpack_sample(uvec4 s) {
    vec2 place = vec2(s.w & 0x3fffu, s.w >> 14 & 0x3fffu) / 256.0 - 16.0;
    return LocalSample(place.x, place.y, uintBitsToFloat(s.x), uintBitsToFloat(s.y), float(s.z >> 8) / 16777216.0);
}
uint index_of(uvec4 s) {
    return s.w >> 28 << 8 | (s.z & 0xffu);
}
