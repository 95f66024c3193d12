// Twin of scene/texture.h: mip pyramids of 8-bit texels, all of them in one buffer, decoded on the way out.

#include "scene/wrap.glsl"

const int kMostLevels = 20;

struct Pyramid {
    int width, height, level_count, is_color;
    int first[kMostLevels];  // texel of each level
};

// TextureRef and uv_matrix() of it. Of no pyramid (-1) it is white.
struct BoundTexture {
    int pyramid, set;
    int wrap_s, wrap_t;
    vec4 matrix;
    vec2 offset;
    int nearest, mipmapped;
};

layout(std430, binding = 4) restrict readonly buffer Pyramids { Pyramid pyramids[]; };
layout(std430, binding = 6) restrict readonly buffer Tables {
    vec4 harmonics[9];      // of the environment
    ivec4 sky_levels[8];    // of the environment: width, height, first texel
    float value_of_code[512];  // of data, of colours
    vec2 specular_albedos[32 * 32];
    float sheen_albedos[16 * 16];
};
layout(binding = 4) uniform usamplerBuffer texels;

vec4 decode(int p, int place) {
    uvec4 code = texelFetch(texels, place);
    uint table = pyramids[p].is_color != 0 ? 256u : 0u;
    return vec4(value_of_code[table + code.r], value_of_code[table + code.g], value_of_code[table + code.b],
                float(code.a) * (1.0 / 255.0));
}

ivec2 level_size(int p, int level) {
    return max(ivec2(1), ivec2(pyramids[p].width, pyramids[p].height) >> level);
}

// The two texels on both sides of a coordinate, and the share of the second; without it where the nearest is wanted.
struct Between {
    int first, second;
    float share;
};

Between between(int wrap, float coordinate, int n, bool nearest) {
    float x = reduced(wrap, coordinate) * float(n) - (nearest ? 0.0 : 0.5);
    float below = floor(x);
    int i = int(below);
    return Between(wrapped(wrap, i, n), wrapped(wrap, i + 1, n), nearest ? 0.0 : x - below);
}

vec4 bilinear(BoundTexture t, vec2 uv, int level, bool nearest) {
    ivec2 size = level_size(t.pyramid, level);
    Between x = between(t.wrap_s, uv.x, size.x, nearest), y = between(t.wrap_t, uv.y, size.y, nearest);
    int first = pyramids[t.pyramid].first[level], upper = first + y.first * size.x, lower = first + y.second * size.x;
    vec4 a = decode(t.pyramid, upper + x.first), b = decode(t.pyramid, upper + x.second);
    vec4 c = decode(t.pyramid, lower + x.first), d = decode(t.pyramid, lower + x.second);
    vec4 above = a + (b - a) * x.share, below = c + (d - c) * x.share;
    return above + (below - above) * y.share;
}

// Pyramid::sample(). One bilinear() for both levels: compilers copy functions to where they are called, and some take
// minutes for what comes out.
vec4 sample_pyramid(BoundTexture t, vec2 uv, float level) {
    bool finest = !(level > 0.0) || (t.nearest != 0 && t.mipmapped == 0);
    int coarsest = pyramids[t.pyramid].level_count - 1, fine = finest ? 0 : int(min(level, float(coarsest)));
    float share = finest || fine == coarsest ? 0.0 : level - float(fine);
    int last = share > 0.0 ? fine + 1 : fine;
    vec4 color = vec4(0.0);
    for (int i = fine; i <= last; ++i) {
        vec4 here = bilinear(t, uv, i, finest && t.nearest != 0);
        color = i == fine ? here : color + (here - color) * share;
    }
    return color;
}
