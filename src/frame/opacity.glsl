// Twin of frame/opacity.h: alpha masks and stochastic transparency (Enderton, Sintorn, Shirley, Luebke 2010), with the
// look-up of scene/texture.cpp. Of the part that is drawn; glass is not here (gl/opacity_upload.cpp refuses it).

#include "base/number.glsl"

const int kOpaque = 0, kMask = 1, kBlend = 2;           // AlphaMode
const int kMixedOpacity = 0, kSolid = 1, kClear = 2;            // OpacityClass
const int kRepeat = 0, kMirroredRepeat = 1, kClamp = 2; // Wrap

uniform int samples_per_pixel;
uniform uint sample_seed;

// Of a part: what of opacity_terms() is not a triangle's own.
struct Surface {
    int alpha_mode;
    bool corner_alphas, textured, nearest_texel, texture_turned;
    int first_record;  // of the part's first triangle
    int first_code;    // of its texture
    float alpha_cutoff, alpha_factor, texture_alpha;
    ivec2 texture_size, texture_wrap;
    vec4 texture_matrix;
    vec2 texture_offset;
};

// Three for each triangle: uv of corners 0 and 1; of corner 2, class; alphas of the corners.
layout(binding = 1) uniform samplerBuffer opacity_records;
layout(binding = 2) uniform usamplerBuffer opacity_codes;
layout(binding = 3) uniform usamplerBuffer surfaces;  // five for each part, as gl/opacity_upload.cpp writes them

Surface surface_of(int part) {
    uvec4 a = texelFetch(surfaces, 5 * part);
    uvec4 b = texelFetch(surfaces, 5 * part + 1), c = texelFetch(surfaces, 5 * part + 2);
    uvec4 d = texelFetch(surfaces, 5 * part + 3), e = texelFetch(surfaces, 5 * part + 4);
    return Surface(int(a.x), (a.y & 1u) != 0u, (a.y & 2u) != 0u, (a.y & 4u) != 0u, (a.y & 8u) != 0u, int(a.z), int(a.w),
                   uintBitsToFloat(b.x), uintBitsToFloat(b.y), uintBitsToFloat(b.z), ivec2(c.xy), ivec2(c.zw),
                   uintBitsToFloat(d), uintBitsToFloat(e.xy));
}

int opacity_class(Surface s, uint in_part) {
    return s.alpha_mode == kOpaque ? kSolid
                                   : int(texelFetch(opacity_records, 3 * (s.first_record + int(in_part)) + 1).z);
}

int wrapped(int wrap, int i, int n) {
    if (wrap == kClamp) return clamp(i, 0, n - 1);
    int period = wrap == kRepeat ? n : 2 * n;
    i = (i + period) % period;  // i is at least -1
    return i < n ? i : period - 1 - i;
}

// Into one period.
float reduced(int wrap, float x) {
    if (wrap == kClamp) return x > 0.0 ? min(x, 1.0) : 0.0;
    if (!(abs(x) < 8388608.0)) return 0.0;
    precise float once = x - floor(x), twice = x - 2.0 * floor(0.5 * x);
    return wrap == kRepeat ? once : twice;
}

float code_at(Surface s, int x, int y) {
    return float(texelFetch(opacity_codes, s.first_code + y * s.texture_size.x + x).r);
}

float texture_opacity(Surface s, vec2 uv) {
    precise vec2 at = vec2(reduced(s.texture_wrap.x, uv.x), reduced(s.texture_wrap.y, uv.y)) * vec2(s.texture_size);
    if (s.nearest_texel) {
        precise float code = code_at(s, wrapped(s.texture_wrap.x, int(floor(at.x)), s.texture_size.x),
                                     wrapped(s.texture_wrap.y, int(floor(at.y)), s.texture_size.y)) *
                             (1.0 / 255.0);
        return code;
    }
    precise vec2 between = at - 0.5;
    precise vec2 share = between - floor(between);
    ivec2 i = ivec2(floor(between));
    int x0 = wrapped(s.texture_wrap.x, i.x, s.texture_size.x), x1 = wrapped(s.texture_wrap.x, i.x + 1, s.texture_size.x);
    int y0 = wrapped(s.texture_wrap.y, i.y, s.texture_size.y), y1 = wrapped(s.texture_wrap.y, i.y + 1, s.texture_size.y);
    precise float above = code_at(s, x0, y0) + (code_at(s, x1, y0) - code_at(s, x0, y0)) * share.x;
    precise float below = code_at(s, x0, y1) + (code_at(s, x1, y1) - code_at(s, x0, y1)) * share.x;
    precise float code = (above + (below - above) * share.y) * (1.0 / 255.0);
    return code;
}

vec2 transformed(Surface s, vec2 uv) {
    precise vec2 straight = s.texture_matrix.xw * uv + s.texture_offset;
    precise vec2 turned = s.texture_matrix.xy * uv.x + s.texture_matrix.zw * uv.y + s.texture_offset;
    return s.texture_turned ? turned : straight;
}

uint mixed(uint x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

// Kensler 2013, Correlated Multi-Jittered Sampling, section 4.
uint permuted(uint i, uint n, uint seed) {
    uint mask = n - 1u;
    for (int shift = 1; shift < 32; shift *= 2) mask |= mask >> shift;
    do {
        i = (i + seed) & mask;
        i ^= (seed >> 16) & mask;
        i *= 0xe170893du;
        i = (i ^ (seed >> 8)) & mask;
        i ^= i >> 4;
        i = (i * (0x0929eb3fu ^ ((seed >> 23) << 1))) & mask;
        i ^= i >> 1;
        i = (i * 0x6935fa69u) & mask;
        i ^= i >> 11;
        i = (i * 0x74dcb303u) & mask;
        i ^= i >> 2;
        i = (i * 0x9e501cc3u) & mask;
        i ^= i >> 2;
    } while (i >= n);
    return i;
}

// What alpha must exceed at a sample of a blended triangle.
float opacity_threshold(uint triangle, ivec2 pixel, uint index) {
    uint place = mixed(mixed(uint(pixel.x)) + uint(pixel.y));
    uint seed = mixed(place + mixed(triangle + 0x9e3779b9u) + mixed(sample_seed));
    uint n = uint(samples_per_pixel);
    precise float offset = float(mixed(seed + index + 1u) >> 8) / 16777216.0;
    precise float sum = float(permuted(index % n, n, seed)) + offset;
    return min(quotient(sum, float(n)), 1.0 - 1.0 / 16777216.0);
}

// `in_part`: the triangle within its part; b: barycentrics of the sample.
bool is_opaque_at(Surface s, uint triangle, uint in_part, vec3 b, ivec2 pixel, uint index) {
    int known = opacity_class(s, in_part);
    if (known != kMixedOpacity) return known == kSolid;
    int record = 3 * (s.first_record + int(in_part));
    vec4 uv01 = texelFetch(opacity_records, record), uv2 = texelFetch(opacity_records, record + 1),
         alphas = texelFetch(opacity_records, record + 2);
    precise vec2 uv = b[0] * uv01.xy + b[1] * uv01.zw + b[2] * uv2.xy;
    precise float of_corners = b[0] * alphas.x + b[1] * alphas.y + b[2] * alphas.z;
    precise float alpha = s.alpha_factor * (s.corner_alphas ? of_corners : 1.0) *
                          (s.textured ? texture_opacity(s, transformed(s, uv)) : s.texture_alpha);
    return s.alpha_mode == kMask ? alpha >= s.alpha_cutoff : alpha > opacity_threshold(triangle, pixel, index);
}
