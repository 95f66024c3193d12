// Second of four: an invocation for each point.

layout(local_size_x = 64) in;

#include "shade/shaded_triangle.glsl"

void main() {
    uint item = item_index();
    if (item < point_count) shade_point(first_point + item, item * uint(casting_lights));
}
