#include "scene/texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "base/float4.h"
#include "base/parallel.h"
#include "scene/tangents.h"

namespace pentaprism {
namespace {

// IEC 61966-2-1.
double srgb_to_linear(double x) {
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

using Codes = std::array<float, 256>;

const Codes& codes_of(Encoding encoding) {
    static const Codes srgb = [] {
        Codes codes;
        for (int i = 0; i < 256; ++i) codes[i] = static_cast<float>(srgb_to_linear(i / 255.0));
        return codes;
    }();
    static const Codes linear = [] {
        Codes codes;
        for (int i = 0; i < 256; ++i) codes[i] = static_cast<float>(i / 255.0);
        return codes;
    }();
    return encoding == Encoding::kSrgb ? srgb : linear;
}

// Nearest code on the encoded scale, by bisection of the borders between codes: no pow() for each texel.
std::uint8_t encode(const Codes& borders, float linear) {
    return static_cast<std::uint8_t>(std::upper_bound(borders.begin(), borders.end() - 1, linear) - borders.begin());
}

const Codes& borders_of(Encoding encoding) {
    static const Codes srgb = [] {
        Codes borders{};
        for (int i = 0; i < 255; ++i) borders[i] = static_cast<float>(srgb_to_linear((i + 0.5) / 255.0));
        return borders;
    }();
    static const Codes linear = [] {
        Codes borders{};
        for (int i = 0; i < 255; ++i) borders[i] = static_cast<float>((i + 0.5) / 255.0);
        return borders;
    }();
    return encoding == Encoding::kSrgb ? srgb : linear;
}

// What texel i of a level of n / 2 (rounded down) texels takes from the finer level: two texels, or three if n is odd,
// in proportion to the length they cover.
struct Taps {
    int first = 0, count = 1;
    float weight[3] = {1.0f, 0.0f, 0.0f};
};

Taps taps_of(int fine, int i) {
    if (fine == 1) return {};
    const int coarse = fine / 2;
    if (fine % 2 == 0) return {2 * i, 2, {0.5f, 0.5f, 0.0f}};
    const float scale = 1.0f / static_cast<float>(fine);
    return {2 * i, 3, {(coarse - i) * scale, coarse * scale, (i + 1) * scale}};
}

int wrapped(Wrap wrap, int i, int n) {
    if (wrap == Wrap::kClampToEdge) return std::clamp(i, 0, n - 1);
    const int period = wrap == Wrap::kRepeat ? n : 2 * n;
    i %= period;
    if (i < 0) i += period;
    return i < n ? i : period - 1 - i;
}

// std::floor is a call where SSE4.1 is not assumed, and look-ups are made of it. |x| < 2^31.
int floor_of(float x) {
    const int i = static_cast<int>(x);
    return i - (x < static_cast<float>(i) ? 1 : 0);
}

// Into one period, so that multiplying by the size keeps the fraction of a texel. Not a number, or so large that there
// is no fraction: 0.
float reduced(Wrap wrap, float x) {
    if (wrap == Wrap::kClampToEdge) return x > 0.0f ? std::min(x, 1.0f) : 0.0f;
    if (!(std::abs(x) < 0x1p23f)) return 0.0f;
    if (wrap == Wrap::kRepeat) return x - static_cast<float>(floor_of(x));
    return x - 2.0f * static_cast<float>(floor_of(0.5f * x));
}

// The two texels on both sides of a coordinate, and the share of the second.
struct Between {
    int first, second;
    float share;
};

inline Between between(Wrap wrap, float coordinate, int n) {
    const float x = reduced(wrap, coordinate) * static_cast<float>(n) - 0.5f;
    const int i = floor_of(x);
    const float share = x - static_cast<float>(i);
    if (i >= 0 && i + 1 < n) return {i, i + 1, share};  // no edge: the same in all modes
    return {wrapped(wrap, i, n), wrapped(wrap, i + 1, n), share};
}

int texel_at(Wrap wrap, float coordinate, int n) {
    return wrapped(wrap, floor_of(reduced(wrap, coordinate) * static_cast<float>(n)), n);
}

glm::vec4 mix(const glm::vec4& a, const glm::vec4& b, float share) {
    return a + (b - a) * share;
}

}  // namespace

Pyramid::Pyramid(const Image& image, Encoding encoding, bool weight_by_alpha)
    : color_of_code_(codes_of(encoding).data()) {
    const std::size_t texels = static_cast<std::size_t>(std::max(0, image.width)) * std::max(0, image.height);
    if (texels == 0 || image.texels.size() < 4 * texels) {
        texels_ = {0xffffffffu};
        levels_.emplace_back();
        return;
    }
    levels_.push_back({image.width, image.height, 0});
    std::size_t all = texels;
    while (levels_.back().width > 1 || levels_.back().height > 1) {
        const Level& fine = levels_.back();
        levels_.push_back({std::max(1, fine.width / 2), std::max(1, fine.height / 2), all});
        all += static_cast<std::size_t>(levels_.back().width) * levels_.back().height;
    }
    texels_.resize(all);
    std::memcpy(texels_.data(), image.texels.data(), 4 * texels);
    for (std::size_t i = 1; i < levels_.size(); ++i) halve(levels_[i - 1], levels_[i], weight_by_alpha);

    bool opaque = true;
    for (std::size_t i = 0; i < texels && opaque; ++i) opaque = image.texels[4 * i + 3] == 255;
    if (opaque) return;
    opacity_.resize(texels + kBeyondCodes);
    for (std::size_t i = 0; i < texels; ++i) opacity_[i] = image.texels[4 * i + 3];
}

void Pyramid::halve(const Level& fine, const Level& coarse, bool weight_by_alpha) {
    const bool srgb = color_of_code_ == codes_of(Encoding::kSrgb).data();
    const Codes& borders = borders_of(srgb ? Encoding::kSrgb : Encoding::kLinear);
    const Codes& alpha_borders = borders_of(Encoding::kLinear);
    std::uint8_t* out = reinterpret_cast<std::uint8_t*>(&texels_[coarse.first]);
    for (int y = 0; y < coarse.height; ++y) {
        const Taps rows = taps_of(fine.height, y);
        for (int x = 0; x < coarse.width; ++x, out += 4) {
            const Taps columns = taps_of(fine.width, x);
            glm::vec4 sum(0.0f);      // all texels alike
            glm::vec3 covered(0.0f);  // colours by opacity
            for (int j = 0; j < rows.count; ++j) {
                const std::uint8_t* row = bytes_of(fine) + 4 * (static_cast<std::size_t>(rows.first + j) * fine.width);
                for (int i = 0; i < columns.count; ++i) {
                    const glm::vec4 value = decode(row + 4 * (columns.first + i));
                    const float weight = rows.weight[j] * columns.weight[i];
                    sum += weight * value;
                    covered += weight * value.w * glm::vec3(value);
                }
            }
            const glm::vec3 color = weight_by_alpha && sum.w > 0.0f ? covered / sum.w : glm::vec3(sum);
            for (int c = 0; c < 3; ++c) out[c] = encode(borders, color[c]);
            out[3] = encode(alpha_borders, sum.w);
        }
    }
}

glm::vec4 Pyramid::decode(const std::uint8_t* texel) const {
    return {color_of_code_[texel[0]], color_of_code_[texel[1]], color_of_code_[texel[2]], texel[3] * (1.0f / 255.0f)};
}

glm::vec4 Pyramid::texel(int level, int x, int y) const {
    const Level& from = levels_[level];
    return decode(bytes_of(from) + 4 * (static_cast<std::size_t>(y) * from.width + x));
}

glm::vec4 Pyramid::bilinear(const Level& level, const TextureRef& ref, glm::vec2 uv) const {
    const Between x = between(ref.wrap_s, uv.x, level.width), y = between(ref.wrap_t, uv.y, level.height);
    const std::uint8_t* upper = bytes_of(level) + 4 * (static_cast<std::size_t>(y.first) * level.width);
    const std::uint8_t* lower = bytes_of(level) + 4 * (static_cast<std::size_t>(y.second) * level.width);
    const auto lanes = [this](const std::uint8_t* t) {
        return Float4{color_of_code_[t[0]], color_of_code_[t[1]], color_of_code_[t[2]], t[3] * (1.0f / 255.0f)};
    };
    const Float4 a = lanes(upper + 4 * x.first), b = lanes(upper + 4 * x.second);
    const Float4 c = lanes(lower + 4 * x.first), d = lanes(lower + 4 * x.second);
    const Float4 above = a + (b - a) * splat(x.share), below = c + (d - c) * splat(x.share);
    const Float4 mixed = above + (below - above) * splat(y.share);
    return {mixed[0], mixed[1], mixed[2], mixed[3]};
}

glm::vec4 Pyramid::nearest(const Level& level, const TextureRef& ref, glm::vec2 uv) const {
    const int x = texel_at(ref.wrap_s, uv.x, level.width), y = texel_at(ref.wrap_t, uv.y, level.height);
    return decode(bytes_of(level) + 4 * (static_cast<std::size_t>(y) * level.width + x));
}

glm::vec4 Pyramid::sample(const TextureRef& ref, glm::vec2 uv, float level) const {
    if (!(level > 0.0f) || (ref.nearest && !ref.mipmapped))
        return ref.nearest ? nearest(levels_[0], ref, uv) : bilinear(levels_[0], ref, uv);
    const float coarsest = static_cast<float>(level_count() - 1);
    if (level >= coarsest) return bilinear(levels_.back(), ref, uv);
    const int fine = static_cast<int>(level);
    return mix(bilinear(levels_[fine], ref, uv), bilinear(levels_[fine + 1], ref, uv),
               level - static_cast<float>(fine));
}

float Pyramid::alpha(const TextureRef& ref, glm::vec2 uv) const {
    if (opacity_.empty()) return bytes_of(levels_[0])[3] * (1.0f / 255.0f);
    const Level& level = levels_[0];
    if (ref.nearest) {
        const int x = texel_at(ref.wrap_s, uv.x, level.width), y = texel_at(ref.wrap_t, uv.y, level.height);
        return opacity_[static_cast<std::size_t>(y) * level.width + x] * (1.0f / 255.0f);
    }
    const Between x = between(ref.wrap_s, uv.x, level.width), y = between(ref.wrap_t, uv.y, level.height);
    const std::uint8_t* upper = &opacity_[static_cast<std::size_t>(y.first) * level.width];
    const std::uint8_t* lower = &opacity_[static_cast<std::size_t>(y.second) * level.width];
    const float above = upper[x.first] + (upper[x.second] - upper[x.first]) * x.share;
    const float below = lower[x.first] + (lower[x.second] - lower[x.first]) * x.share;
    return (above + (below - above) * y.share) * (1.0f / 255.0f);
}

Textures::Textures(const Scene& scene) {
    const std::size_t images = scene.images.size();
    std::vector<std::uint8_t> as_color(images), as_data(images), cut_out(images);
    const auto mark = [&](std::vector<std::uint8_t>& uses, const TextureRef& ref) {
        if (ref.image >= 0 && static_cast<std::size_t>(ref.image) < images) uses[ref.image] = 1;
    };
    for (const Material& material : scene.materials) {
        mark(as_color, material.base_color_texture);
        mark(as_color, material.emissive_texture);
        mark(as_data, material.metallic_roughness_texture);
        mark(as_data, material.normal_texture);
        mark(as_data, material.occlusion_texture);
        mark(as_data, material.specular_texture);
        mark(as_color, material.specular_color_texture);
        for (const TextureRef* ref :
             {&material.clearcoat_texture, &material.clearcoat_roughness_texture, &material.clearcoat_normal_texture,
              &material.transmission_texture, &material.sheen_roughness_texture})
            mark(as_data, *ref);
        mark(as_color, material.sheen_color_texture);
        if (material.alpha_mode != AlphaMode::kOpaque) mark(cut_out, material.base_color_texture);
    }
    colors_.resize(images);
    data_.resize(images);
    parallel_for(images, [&](std::size_t i) {
        if (as_color[i]) colors_[i] = std::make_unique<Pyramid>(scene.images[i], Encoding::kSrgb, cut_out[i] != 0);
        if (as_data[i]) data_[i] = std::make_unique<Pyramid>(scene.images[i], Encoding::kLinear, false);
    });

    std::vector<std::unique_ptr<const OpacityRange>> ranges(images);
    parallel_for(images, [&](std::size_t i) {
        if (cut_out[i]) ranges[i] = std::make_unique<OpacityRange>(*colors_[i]);
    });
    tangents_.resize(scene.meshes.size());
    parallel_for(scene.meshes.size(), [&](std::size_t i) {
        for (const Primitive& primitive : scene.meshes[i].primitives) {
            tangents_[i].emplace_back();
            if (primitive.material == kNone) continue;
            const Material& material = scene.materials[primitive.material];
            const bool mapped = material.normal_texture.image != kNone;
            if (!mapped && material.clearcoat_normal_texture.image == kNone) continue;
            const TextureRef& ref = mapped ? material.normal_texture : material.clearcoat_normal_texture;
            tangents_[i].back() = primitive.tangents.size() == primitive.positions.size()
                                      ? primitive.tangents
                                      : make_tangents(primitive, ref.texcoord == 1 ? 1 : 0);
        }
    });
    opacity_classes_.resize(scene.meshes.size());
    parallel_for(scene.meshes.size(), [&](std::size_t i) {
        for (const Primitive& primitive : scene.meshes[i].primitives) {
            const Index material = primitive.material;
            const Index image = material == kNone ? kNone : scene.materials[material].base_color_texture.image;
            const bool known = image >= 0 && static_cast<std::size_t>(image) < images;
            opacity_classes_[i].push_back(classify_opacity(scene, known ? ranges[image].get() : nullptr, primitive));
        }
    });
}

std::shared_ptr<const Textures> make_textures(const Scene& scene) {
    return std::make_shared<const Textures>(scene);
}

// KHR_texture_transform: T * R * S, where R turns counter-clockwise as seen with v pointing down (its example, the
// lower left quadrant turned by 90 degrees, settles the sign).
glm::vec4 uv_matrix(const TextureRef& ref) {
    if (ref.rotation == 0.0f) return {ref.scale.x, 0.0f, 0.0f, ref.scale.y};
    const float c = std::cos(ref.rotation), s = std::sin(ref.rotation);
    return {c * ref.scale.x, -s * ref.scale.x, s * ref.scale.y, c * ref.scale.y};
}

}  // namespace pentaprism
