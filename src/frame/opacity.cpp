#include "frame/opacity.h"

#include <algorithm>

#include "sample/net.h"

namespace pentaprism {
namespace {

// A permutation of [0, n) chosen by `seed`: Kensler 2013, Correlated Multi-Jittered Sampling, section 4 (permute the
// next power of two by steps that can be undone, again until the result lies in the range).
std::uint32_t permuted(std::uint32_t i, std::uint32_t n, std::uint32_t seed) {
    std::uint32_t mask = n - 1;
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

// g * digit + c in the field of four elements, g (not 0) and c by chance: of these twelve permutations of a base-4
// digit each pair of digits becomes each other pair equally often.
std::uint32_t permuted_digit(std::uint32_t digit, std::uint32_t random) {
    constexpr std::uint32_t kProducts = 0x9c78e4;  // two bits for each, [g - 1][digit]
    const std::uint32_t g = ((random >> 16) * 3u) >> 16;
    return ((kProducts >> (8u * g + 2u * digit)) & 3u) ^ (random & 3u);
}

// Digits of `place` from the last to the first become those of the result from the first to the last, each permuted by
// chance, which depends on the digits of `place` before it and on those of the result before it: a (0, 2)-net with
// random permutations on both of its sides. Base 4, but for the last of the lowest `spp_bits` and of all `bits` where
// they are odd.
std::uint32_t random_net(std::uint32_t place, int spp_bits, int bits, std::uint32_t seed) {
    std::uint32_t result = 0;
    for (int done = 0; done < bits;) {
        const int width = done + 1 == spp_bits || done + 1 == bits ? 1 : 2;
        const std::uint32_t before = place >> (done + width);
        const std::uint32_t random = mix(seed + (static_cast<std::uint32_t>(done) << 16) + (before << done | result));
        const std::uint32_t digit = place >> done;
        result = width == 2 ? result << 2 | permuted_digit(digit & 3u, random) : result << 1 | ((digit ^ random) & 1u);
        done += width;
    }
    return result;
}

// a * b in the field of sixteen elements, x^4 = x + 1.
std::uint32_t product16(std::uint32_t a, std::uint32_t b) {
    std::uint32_t sum = 0;
    for (int i = 0; i < 4; ++i) sum ^= (a >> i & 1u) * (b << i);
    return (sum & 15u) ^ (sum >> 4) ^ (sum >> 4 << 1);
}

// The pixels of a block of 4 x 4 read one net, each from another place on: its number in the block times a factor by
// chance is added to the time, digit by digit. Where two triangles have different factors, their places differ by all
// sixteen numbers, so what they hide together evens out over the block.
float threshold_over_time(std::uint32_t surface, std::uint32_t px, std::uint32_t py, std::uint32_t index, int spp) {
    const int spp_bits = std::bit_width(static_cast<unsigned>(spp) - 1u), bits = std::max(spp_bits, 4);
    const std::uint32_t block = mix(mix(mix(px >> 2) + (py >> 2)) + surface);
    const std::uint32_t lane = (px & 1u) | (py & 1u) << 1 | (px & 2u) << 1 | (py & 2u) << 2;
    const std::uint32_t place = index ^ product16(1u + ((block >> 16) * 15u >> 16), lane);
    const std::uint32_t stratum = random_net(place, spp_bits, bits, block);
    const std::uint32_t random = mix(block + 0x9e3779b9u * (1u + (index << 4 | lane)));
    return static_cast<float>((stratum << (32 - bits) | random >> bits) >> 8) * 0x1p-24f;
}

// A triangle's corners in its Primitive.
struct Corners {
    const Frame& frame;
    std::uint32_t triangle;
    std::array<std::uint32_t, 3> vertices;

    // What corner k has of an attribute; of a piece, a mix of what all of it has.
    template <class T>
    T at(int k, const std::vector<T>& values) const {
        if (frame.pieces.empty()) return values[vertices[k]];
        const glm::vec3 b =
            frame.in_source(triangle, {k == 0 ? 1.0f : 0.0f, k == 1 ? 1.0f : 0.0f, k == 2 ? 1.0f : 0.0f});
        return b.x * values[vertices[0]] + b.y * values[vertices[1]] + b.z * values[vertices[2]];
    }
    glm::vec2 mixed(const std::vector<glm::vec2>& values, const float b[3]) const {
        return b[0] * at(0, values) + b[1] * at(1, values) + b[2] * at(2, values);
    }
};

float vertex_alpha(const Primitive& primitive, const Corners& corners, const float b[3]) {
    const std::vector<glm::vec4>& colors = primitive.colors;
    if (colors.empty()) return 1.0f;
    return b[0] * corners.at(0, colors).w + b[1] * corners.at(1, colors).w + b[2] * corners.at(2, colors).w;
}

float texture_alpha(const Frame& frame, const Primitive& primitive, const TextureRef& ref, const Corners& corners,
                    const float b[3]) {
    const Pyramid* pyramid = frame.textures ? frame.textures->color(ref) : nullptr;
    if (!pyramid) return 1.0f;
    const std::vector<glm::vec2>& uv = primitive.texcoords[ref.texcoord == 1 ? 1 : 0];
    if (uv.empty()) return pyramid->alpha(ref, transform_uv(ref, {0.0f, 0.0f}));
    return pyramid->alpha(ref, transform_uv(ref, corners.mixed(uv, b)));
}

float transmission(const Frame& frame, const Material& material, const Primitive& primitive, const Corners& corners,
                   const float b[3]) {
    const TextureRef& ref = material.transmission_texture;
    const Pyramid* pyramid = frame.textures ? frame.textures->data(ref) : nullptr;
    const std::vector<glm::vec2>& uv = primitive.texcoords[ref.texcoord == 1 ? 1 : 0];
    if (!pyramid || uv.empty()) return material.transmission;
    return material.transmission * pyramid->sample(ref, transform_uv(ref, corners.mixed(uv, b)), 0.0f).x;
}

}  // namespace

float opacity_threshold(std::uint32_t triangle, int px, int py, int sample_index, const OpacityPattern& pattern) {
    const std::uint32_t x = static_cast<std::uint32_t>(px), y = static_cast<std::uint32_t>(py);
    const std::uint32_t index = static_cast<std::uint32_t>(sample_index);
    const std::uint32_t surface = mix(triangle + 0x9e3779b9u) + mix(pattern.seed);
    if (pattern.over_time) return threshold_over_time(surface, x, y, index, pattern.spp);
    const std::uint32_t seed = mix(mix(mix(x) + y) + surface);
    const std::uint32_t n = static_cast<std::uint32_t>(std::max(1, pattern.spp));
    const float offset = static_cast<float>(mix(seed + index + 1u) >> 8) * 0x1p-24f;
    return std::min((static_cast<float>(permuted(index % n, n, seed)) + offset) / static_cast<float>(n),
                    1.0f - 0x1p-24f);
}

namespace {

void set_glass(const Frame& frame, const Material& material, const Primitive& primitive, const Corners& corners,
               OpacityTerms& terms) {
    terms.glass = true;
    terms.blends = material.alpha_mode == AlphaMode::kBlend;
    terms.transmission = material.transmission;
    const TextureRef& ref = material.transmission_texture;
    const Pyramid* pyramid = frame.textures ? frame.textures->data(ref) : nullptr;
    const std::vector<glm::vec2>& uv = primitive.texcoords[ref.texcoord == 1 ? 1 : 0];
    if (!pyramid || uv.empty()) return;
    terms.transmission_texture = pyramid;
    terms.transmission_ref = &ref;
    for (int k = 0; k < 3; ++k) terms.transmission_uv[k] = corners.at(k, uv);
}

}  // namespace

OpacityTerms opacity_terms(const Frame& frame, std::uint32_t triangle) {
    OpacityTerms terms;
    const Part& part = frame.parts[frame.part_of[triangle]];
    if (part.material == kNone) return terms;
    const Material& material = frame.scene->materials[part.material];
    if (part.alpha_mode == AlphaMode::kOpaque) return terms;
    const Primitive& primitive = frame.scene->meshes[part.placement.mesh].primitives[part.placement.primitive];
    const Corners corners{frame, triangle, frame.vertices(triangle)};
    if (material.transmission > 0.0f) set_glass(frame, material, primitive, corners, terms);
    terms.mode = part.alpha_mode;
    terms.cutoff = material.alpha_cutoff;
    terms.factor = material.base_color.w;
    terms.colored = !primitive.colors.empty();
    for (int k = 0; terms.colored && k < 3; ++k) terms.color[k] = corners.at(k, primitive.colors).w;
    const TextureRef& ref = material.base_color_texture;
    const Pyramid* pyramid = frame.textures ? frame.textures->color(ref) : nullptr;
    if (!pyramid) return terms;
    const std::vector<glm::vec2>& uv = primitive.texcoords[ref.texcoord == 1 ? 1 : 0];
    if (uv.empty() || pyramid->opacity_codes() == nullptr) {
        terms.texture_alpha = pyramid->alpha(ref, transform_uv(ref, {0.0f, 0.0f}));
        return terms;
    }
    terms.texture = pyramid;
    terms.ref = &ref;
    for (int k = 0; k < 3; ++k) terms.uv[k] = corners.at(k, uv);
    return terms;
}

OpacityClass opacity_class(const Frame& frame, std::uint32_t triangle) {
    const Part& part = frame.parts[frame.part_of[triangle]];
    if (part.material == kNone) return OpacityClass::kSolid;
    const bool glass = frame.scene->materials[part.material].transmission > 0.0f;
    if (part.alpha_mode == AlphaMode::kOpaque) return OpacityClass::kSolid;
    if (!frame.textures || glass) return OpacityClass::kMixed;
    const OpacityClass* classes = frame.textures->opacity_classes(part.placement.mesh, part.placement.primitive);
    return classes ? classes[frame.source(triangle)] : OpacityClass::kMixed;
}

float opacity_at(const Frame& frame, std::uint32_t triangle, const float barycentrics[3]) {
    const OpacityClass known = opacity_class(frame, triangle);
    if (known != OpacityClass::kMixed) return known == OpacityClass::kSolid ? 1.0f : 0.0f;
    const Part& part = frame.parts[frame.part_of[triangle]];
    const Material& material = frame.scene->materials[part.material];
    const Primitive& primitive = frame.scene->meshes[part.placement.mesh].primitives[part.placement.primitive];
    const Corners corners{frame, triangle, frame.vertices(triangle)};
    const float alpha = material.base_color.w * vertex_alpha(primitive, corners, barycentrics) *
                        texture_alpha(frame, primitive, material.base_color_texture, corners, barycentrics);
    if (part.alpha_mode == AlphaMode::kMask && !(alpha >= material.alpha_cutoff)) return 0.0f;
    const float opacity = material.alpha_mode == AlphaMode::kBlend ? alpha : 1.0f;
    if (!(material.transmission > 0.0f)) return opacity;
    return opacity * (1.0f - see_through(transmission(frame, material, primitive, corners, barycentrics)));
}

bool is_opaque_at(const Frame& frame, std::uint32_t triangle, const float barycentrics[3], int px, int py,
                  int sample_index, const OpacityPattern& pattern) {
    const float opacity = opacity_at(frame, triangle, barycentrics);
    if (opacity <= 0.0f || opacity >= 1.0f) return opacity >= 1.0f;  // thresholds are in [0, 1)
    return opacity > opacity_threshold(triangle, px, py, sample_index, pattern);
}

bool is_see_through(const Frame& frame, std::uint32_t triangle) {
    const Part& part = frame.parts[frame.part_of[triangle]];
    if (opacity_class(frame, triangle) != OpacityClass::kMixed) return false;
    return part.alpha_mode == AlphaMode::kBlend || frame.scene->materials[part.material].transmission > 0.0f;
}

}  // namespace pentaprism
