#include "scene/opacity_class.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "scene/texture.h"

namespace pentaprism {
namespace {

constexpr float kSlack = 1e-4f;  // of an opacity: more than all roundings of the look-up and of the products

struct Span {
    int first, last;
};

// Texels that bilinear look-ups between two coordinates touch, one more on each side for rounding; all of them where
// that is simpler to say.
Span texels_between(Wrap wrap, float from, float to, int n) {
    const Span all{0, n - 1};
    constexpr float kFar = 1e6f;  // texels: beyond, float no longer knows which texel it is
    if (!(std::abs(from) * static_cast<float>(n) < kFar && std::abs(to) * static_cast<float>(n) < kFar)) return all;
    int first = static_cast<int>(std::floor(from * static_cast<float>(n) - 0.5f)) - 1;
    int last = static_cast<int>(std::floor(to * static_cast<float>(n) - 0.5f)) + 2;
    if (wrap == Wrap::kClampToEdge) return {std::clamp(first, 0, n - 1), std::clamp(last, 0, n - 1)};
    const int period = wrap == Wrap::kRepeat ? n : 2 * n;
    const int shift = (first >= 0 ? first / period : -((period - 1 - first) / period)) * period;
    first -= shift;
    last -= shift;
    if (first >= n && last < 2 * n) return {2 * n - 1 - last, 2 * n - 1 - first};  // mirrored
    return first >= 0 && last < n ? Span{first, last} : all;
}

}  // namespace

OpacityRange::OpacityRange(const Pyramid& pyramid) {
    Level base{pyramid.width(), pyramid.height(), {}, {}};
    for (int y = 0; y < base.height; ++y)
        for (int x = 0; x < base.width; ++x) base.least.push_back(pyramid.opacity_code(x, y));
    base.most = base.least;
    levels_.push_back(std::move(base));
    while (levels_.back().width > 1 || levels_.back().height > 1) {
        const Level& fine = levels_.back();
        Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}, {}};
        for (int y = 0; y < coarse.height; ++y)
            for (int x = 0; x < coarse.width; ++x) {
                std::uint8_t least = 255, most = 0;
                for (int j = 2 * y; j < std::min(2 * y + 2, fine.height); ++j)
                    for (int i = 2 * x; i < std::min(2 * x + 2, fine.width); ++i) {
                        least = std::min(least, fine.least[static_cast<std::size_t>(j) * fine.width + i]);
                        most = std::max(most, fine.most[static_cast<std::size_t>(j) * fine.width + i]);
                    }
                coarse.least.push_back(least);
                coarse.most.push_back(most);
            }
        levels_.push_back(std::move(coarse));
    }
}

OpacityRange::Bounds OpacityRange::over(const TextureRef& ref, float u0, float u1, float v0, float v1) const {
    const Span x = texels_between(ref.wrap_s, u0, u1, levels_[0].width);
    const Span y = texels_between(ref.wrap_t, v0, v1, levels_[0].height);
    // Up to about 16 texels a side: finer bounds than a single texel of a coarser level.
    int level = 0;
    while (std::max(x.last - x.first, y.last - y.first) >> level > 15) ++level;
    const Level& from = levels_[level];
    Bounds bounds{255, 0};
    for (int j = y.first >> level; j <= y.last >> level; ++j)
        for (int i = x.first >> level; i <= x.last >> level; ++i) {
            const std::size_t at = static_cast<std::size_t>(j) * from.width + i;
            bounds.least = std::min<int>(bounds.least, from.least[at]);
            bounds.most = std::max<int>(bounds.most, from.most[at]);
        }
    return bounds;
}

std::vector<OpacityClass> classify_opacity(const Scene& scene, const OpacityRange* range, const Primitive& primitive) {
    if (primitive.material == kNone) return {};
    const Material& material = scene.materials[primitive.material];
    if (material.alpha_mode == AlphaMode::kOpaque) return {};
    const TextureRef& ref = material.base_color_texture;
    const std::vector<glm::vec2>& uvs = primitive.texcoords[ref.texcoord == 1 ? 1 : 0];

    std::vector<OpacityClass> classes(primitive.indices.size() / 3, OpacityClass::kMixed);
    for (std::size_t t = 0; t < classes.size(); ++t) {
        const std::uint32_t* corner = &primitive.indices[3 * t];
        float least = material.base_color.w, most = material.base_color.w;
        if (!primitive.colors.empty()) {
            const float a = primitive.colors[corner[0]].w, b = primitive.colors[corner[1]].w,
                        c = primitive.colors[corner[2]].w;
            least *= std::min({a, b, c});
            most *= std::max({a, b, c});
        }
        if (range) {
            glm::vec2 low(0.0f), high(0.0f);
            for (int k = 0; k < 3; ++k) {
                const glm::vec2 uv = transform_uv(ref, uvs.empty() ? glm::vec2(0.0f) : uvs[corner[k]]);
                low = k == 0 ? uv : glm::min(low, uv);
                high = k == 0 ? uv : glm::max(high, uv);
            }
            const OpacityRange::Bounds bounds = range->over(ref, low.x, high.x, low.y, high.y);
            least *= static_cast<float>(bounds.least) / 255.0f;
            most *= static_cast<float>(bounds.most) / 255.0f;
        }
        if (!(least >= 0.0f)) continue;  // a negative factor, or not a number: whatever it means, the test says it
        if (material.alpha_mode == AlphaMode::kMask) {
            if (least > material.alpha_cutoff + kSlack) classes[t] = OpacityClass::kSolid;
            if (most < material.alpha_cutoff - kSlack) classes[t] = OpacityClass::kClear;
        } else {
            if (least > 1.0f - 1e-6f) classes[t] = OpacityClass::kSolid;
            if (most == 0.0f) classes[t] = OpacityClass::kClear;
        }
    }
    return classes;
}

}  // namespace pentaprism
