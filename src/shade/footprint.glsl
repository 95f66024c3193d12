// Twin of shade/footprint.h: how much of a texture one shading point stands for.

#include "scene/texture.glsl"

const float kMostTaps = 16.0;

// Covariance of the texture coordinates: uu, uv, vv.
vec3 with_axis(vec3 footprint, vec2 axis, float variance) {
    return footprint + variance * vec3(axis.x * axis.x, axis.x * axis.y, axis.y * axis.y);
}

float box_width(float variance) {
    return sqrt(12.0 * max(0.0, variance));
}

// Mean over the footprint: up to 16 trilinear taps along its longer axis, each as wide as the shorter one.
vec4 sample_texture(BoundTexture t, vec2 uv, vec3 footprint) {
    vec2 place = t.matrix.xy * uv.x + t.matrix.zw * uv.y + t.offset;
    float width = float(pyramids[t.pyramid].width), height = float(pyramids[t.pyramid].height);
    float a = t.matrix.x * width, b = t.matrix.z * width, c = t.matrix.y * height, d = t.matrix.w * height;
    float xx = a * a * footprint.x + 2.0 * a * b * footprint.y + b * b * footprint.z;
    float yy = c * c * footprint.x + 2.0 * c * d * footprint.y + d * d * footprint.z;
    float xy = a * c * footprint.x + (a * d + b * c) * footprint.y + b * d * footprint.z;
    float mean = 0.5 * (xx + yy), slant = 0.5 * (xx - yy), spread = sqrt(slant * slant + xy * xy);
    bool known = !isinf(mean + spread) && !isnan(mean + spread);

    float major = box_width(mean + spread);
    float minor = max(max(box_width(mean - spread), major / kMostTaps), 1.0);
    major = max(major, minor);
    float level = known ? log2(minor) : 0.0;
    int taps = known ? int(min(kMostTaps, ceil(major / minor - 0.25))) : 1;

    vec2 axis = slant >= 0.0 ? vec2(slant + spread, xy) : vec2(xy, spread - slant);
    float len = sqrt(axis.x * axis.x + axis.y * axis.y);
    if (taps <= 1 || !(len > 0.0)) {
        taps = 1;
        axis = vec2(0.0);
    } else {
        axis *= major / (len * float(taps));
    }
    vec2 way = axis / vec2(width, height);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < taps; ++i) sum += sample_pyramid(t, place + way * (float(i) - 0.5 * float(taps - 1)), level);
    return sum / float(taps);
}
