// One corner of a triangle at both ends of a motion segment (McGuire, Enderton, Shirley, Luebke 2010): posed and projected
// before, once, for both backends.

layout(location = 0) in vec4 at_open;  // x, y, w, c
layout(location = 1) in vec4 at_close;
layout(location = 2) in float z_at_open;  // orthographic cameras only, else z = w
layout(location = 3) in float z_at_close;

uniform bool orthographic;

out Corner {
    vec4 open, close;
    float z_open, z_close;
} corner;

void main() {
    corner.open = at_open;
    corner.close = at_close;
    corner.z_open = orthographic ? z_at_open : at_open.z;
    corner.z_close = orthographic ? z_at_close : at_close.z;
}
