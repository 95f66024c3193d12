// Twin of frame/opacity.h: alpha masks and stochastic transparency (Enderton, Sintorn, Shirley, Luebke 2010), with the
// look-up of scene/texture.cpp. Of the part that is drawn.

#include "base/number.glsl"
#include "sample/net.glsl"
#include "scene/wrap.glsl"

const int kOpaque = 0, kMask = 1, kBlend = 2;           // AlphaMode
const int kMixedOpacity = 0, kSolid = 1, kClear = 2;            // OpacityClass

uniform int samples_per_pixel;
uniform uint sample_seed;
uniform bool thresholds_over_time;

// One channel of a texture's finest level.
struct OpacityTexture {
    ivec2 size, wrap;
    vec4 matrix;
    vec2 offset;
    int first_code;
    bool nearest_texel, turned;
};

// Of a part: what of opacity_terms() is not a triangle's own.
struct Surface {
    int alpha_mode;
    bool corner_alphas, textured, glass, glass_textured, blends;
    int first_record, stride;  // of the part's first triangle; of each triangle
    float alpha_cutoff, alpha_factor, texture_alpha, transmission;
    OpacityTexture texture, of_glass;
};

// Three for each triangle: uv of corners 0 and 1; of corner 2, class; alphas of the corners. Two more of glass: uv of its
// texture.
layout(binding = 1) uniform samplerBuffer opacity_records;
layout(binding = 2) uniform usamplerBuffer opacity_codes;
layout(binding = 3) uniform usamplerBuffer surfaces;  // eight for each part, as gl/opacity_upload.cpp writes them

OpacityTexture opacity_texture(int at) {
    uvec4 a = texelFetch(surfaces, at), c = texelFetch(surfaces, at + 2);
    return OpacityTexture(ivec2(a.xy), ivec2(a.zw), uintBitsToFloat(texelFetch(surfaces, at + 1)), uintBitsToFloat(c.xy),
                          int(c.z), (c.w & 1u) != 0u, (c.w & 2u) != 0u);
}

Surface surface_of(int part) {
    uvec4 a = texelFetch(surfaces, 8 * part), b = texelFetch(surfaces, 8 * part + 1);
    return Surface(int(a.x), (a.y & 1u) != 0u, (a.y & 2u) != 0u, (a.y & 4u) != 0u, (a.y & 8u) != 0u, (a.y & 16u) != 0u,
                   int(a.z), int(a.w), uintBitsToFloat(b.x), uintBitsToFloat(b.y), uintBitsToFloat(b.z),
                   uintBitsToFloat(b.w), opacity_texture(8 * part + 2), opacity_texture(8 * part + 5));
}

int opacity_class(Surface s, uint in_part) {
    return s.alpha_mode == kOpaque ? kSolid
                                   : int(texelFetch(opacity_records, s.first_record + s.stride * int(in_part) + 1).z);
}

float code_at(OpacityTexture t, int x, int y) {
    return float(texelFetch(opacity_codes, t.first_code + y * t.size.x + x).r);
}

// Texels around a place, upper and lower, left and right, and the shares of the second ones.
struct Around {
    int x0, x1, y0, y1;
    vec2 share;
};

Around around(OpacityTexture t, vec2 uv) {
    precise vec2 at = vec2(reduced(t.wrap.x, uv.x), reduced(t.wrap.y, uv.y)) * vec2(t.size);
    precise vec2 between = t.nearest_texel ? at : at - 0.5;
    precise vec2 share = between - floor(between);
    ivec2 i = ivec2(floor(between));
    return Around(wrapped(t.wrap.x, i.x, t.size.x), wrapped(t.wrap.x, i.x + 1, t.size.x), wrapped(t.wrap.y, i.y, t.size.y),
                  wrapped(t.wrap.y, i.y + 1, t.size.y), t.nearest_texel ? vec2(0.0) : share);
}

float bilinear(float a, float b, float c, float d, vec2 share) {
    precise float above = a + (b - a) * share.x, below = c + (d - c) * share.x;
    precise float sum = above + (below - above) * share.y;
    return sum;
}

// Pyramid::alpha(): codes are mixed, then decoded.
float texture_opacity(OpacityTexture t, vec2 uv) {
    Around p = around(t, uv);
    precise float alpha = bilinear(code_at(t, p.x0, p.y0), code_at(t, p.x1, p.y0), code_at(t, p.x0, p.y1),
                                   code_at(t, p.x1, p.y1), p.share) *
                          (1.0 / 255.0);
    return alpha;
}

// Pyramid::sample() of data at level 0: decoded, then mixed.
float texture_value(OpacityTexture t, vec2 uv) {
    Around p = around(t, uv);
    return bilinear(quotient(code_at(t, p.x0, p.y0), 255.0), quotient(code_at(t, p.x1, p.y0), 255.0),
                    quotient(code_at(t, p.x0, p.y1), 255.0), quotient(code_at(t, p.x1, p.y1), 255.0), p.share);
}

vec2 transformed(OpacityTexture t, vec2 uv) {
    precise vec2 straight = t.matrix.xw * uv + t.offset;
    precise vec2 turned = t.matrix.xy * uv.x + t.matrix.zw * uv.y + t.offset;
    return t.turned ? turned : straight;
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

uint permuted_digit(uint digit, uint random) {
    uint g = ((random >> 16) * 3u) >> 16;
    return ((0x9c78e4u >> (8u * g + 2u * digit)) & 3u) ^ (random & 3u);
}

uint random_net(uint place, int spp_bits, int bits, uint seed) {
    uint result = 0u;
    for (int done = 0; done < bits;) {
        int width = done + 1 == spp_bits || done + 1 == bits ? 1 : 2;
        uint before = place >> (done + width);
        uint random = mixed(seed + (uint(done) << 16) + ((before << done) | result));
        uint digit = place >> done;
        result = width == 2 ? (result << 2) | permuted_digit(digit & 3u, random) : (result << 1) | ((digit ^ random) & 1u);
        done += width;
    }
    return result;
}

uint product16(uint a, uint b) {
    uint sum = 0u;
    for (int i = 0; i < 4; ++i) sum ^= ((a >> i) & 1u) * (b << i);
    return (sum & 15u) ^ (sum >> 4) ^ ((sum >> 4) << 1);
}

float threshold_over_time(uint surface, uvec2 pixel, uint index) {
    int spp_bits = findMSB(samples_per_pixel), bits = max(spp_bits, 4);
    uvec2 of_block = pixel >> 2;
    uint block = mixed(mixed(mixed(of_block.x) + of_block.y) + surface);
    uint lane = (pixel.x & 1u) | ((pixel.y & 1u) << 1) | ((pixel.x & 2u) << 1) | ((pixel.y & 2u) << 2);
    uint place = index ^ product16(1u + (((block >> 16) * 15u) >> 16), lane);
    uint stratum = random_net(place, spp_bits, bits, block);
    uint random = mixed(block + 0x9e3779b9u * (1u + ((index << 4) | lane)));
    return float(((stratum << (32 - bits)) | (random >> bits)) >> 8) / 16777216.0;
}

// What alpha must exceed at a sample of a blended triangle.
float opacity_threshold(uint triangle, ivec2 pixel, uint index) {
    uint surface = mixed(triangle + 0x9e3779b9u) + mixed(sample_seed);
    if (thresholds_over_time) return threshold_over_time(surface, uvec2(pixel), index);
    uint seed = mixed(mixed(mixed(uint(pixel.x)) + uint(pixel.y)) + surface);
    uint n = uint(samples_per_pixel);
    precise float offset = float(mixed(seed + index + 1u) >> 8) / 16777216.0;
    precise float sum = float(permuted(index % n, n, seed)) + offset;
    return min(quotient(sum, float(n)), 1.0 - 1.0 / 16777216.0);
}

// Coordinates at the corners: 0 and 1, 2; b: barycentrics.
vec2 blended_uv(vec4 uv01, vec4 uv2, vec3 b) {
    precise vec2 uv = b[0] * uv01.xy + b[1] * uv01.zw + b[2] * uv2.xy;
    return uv;
}

// see_through() of the transmission there.
float glass_opacity(Surface s, float opacity, int record, vec3 b) {
    float value = 1.0;
    if (s.glass_textured)
        value = texture_value(s.of_glass, transformed(s.of_glass, blended_uv(texelFetch(opacity_records, record + 3),
                                                                             texelFetch(opacity_records, record + 4), b)));
    precise float left = opacity * (1.0 - 0.875 * (s.transmission * value));
    return left;
}

// `in_part`: the triangle within its part; b: barycentrics of the sample.
bool is_opaque_at(Surface s, uint triangle, uint in_part, vec3 b, ivec2 pixel, uint index) {
    int known = opacity_class(s, in_part);
    if (known != kMixedOpacity) return known == kSolid;
    int record = s.first_record + s.stride * int(in_part);
    vec4 alphas = texelFetch(opacity_records, record + 2);
    vec2 uv = blended_uv(texelFetch(opacity_records, record), texelFetch(opacity_records, record + 1), b);
    precise float of_corners = b[0] * alphas.x + b[1] * alphas.y + b[2] * alphas.z;
    precise float alpha = s.alpha_factor * (s.corner_alphas ? of_corners : 1.0) *
                          (s.textured ? texture_opacity(s.texture, transformed(s.texture, uv)) : s.texture_alpha);
    if (s.alpha_mode == kMask && !(alpha >= s.alpha_cutoff)) return false;
    if (!s.glass) return s.alpha_mode == kMask || alpha > opacity_threshold(triangle, pixel, index);
    float opacity = glass_opacity(s, s.blends ? alpha : 1.0, record, b);
    return opacity > 0.0 && (opacity >= 1.0 || opacity > opacity_threshold(triangle, pixel, index));
}
