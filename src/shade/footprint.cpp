#include "shade/footprint.h"

#include <algorithm>
#include <cmath>

namespace pentaprism {
namespace {

constexpr float kMostTaps = 16.0f;

// The box of equal variance: variance = width^2 / 12.
float box_width(float variance) {
    return std::sqrt(12.0f * std::max(0.0f, variance));
}

}  // namespace

glm::vec4 BoundTexture::sample(glm::vec2 uv, const TextureFootprint& footprint) const {
    const glm::vec2 place = {matrix.x * uv.x + matrix.z * uv.y + ref.offset.x,
                             matrix.y * uv.x + matrix.w * uv.y + ref.offset.y};
    // The ellipse in texels: T C T^t with T = size * matrix.
    const float width = static_cast<float>(pyramid->width()), height = static_cast<float>(pyramid->height());
    const float a = matrix.x * width, b = matrix.z * width, c = matrix.y * height, d = matrix.w * height;
    const float xx = a * a * footprint.uu + 2.0f * a * b * footprint.uv + b * b * footprint.vv;
    const float yy = c * c * footprint.uu + 2.0f * c * d * footprint.uv + d * d * footprint.vv;
    const float xy = a * c * footprint.uu + (a * d + b * c) * footprint.uv + b * d * footprint.vv;
    const float mean = 0.5f * (xx + yy), half = 0.5f * (xx - yy), spread = std::sqrt(half * half + xy * xy);
    if (!std::isfinite(mean + spread)) return pyramid->sample(ref, place, 0.0f);

    float major = box_width(mean + spread);
    const float minor = std::max({box_width(mean - spread), major / kMostTaps, 1.0f});
    major = std::max(major, minor);
    const float level = std::log2(minor);
    const int taps = static_cast<int>(std::min(kMostTaps, std::ceil(major / minor - 0.25f)));
    if (taps <= 1) return pyramid->sample(ref, place, level);

    // Unit eigenvector of the larger eigenvalue.
    glm::vec2 axis = half >= 0.0f ? glm::vec2(half + spread, xy) : glm::vec2(xy, spread - half);
    const float length = std::sqrt(axis.x * axis.x + axis.y * axis.y);
    if (!(length > 0.0f)) return pyramid->sample(ref, place, level);
    axis *= major / (length * static_cast<float>(taps));
    const glm::vec2 step = {axis.x / width, axis.y / height};
    glm::vec4 sum(0.0f);
    for (int i = 0; i < taps; ++i)
        sum +=
            pyramid->sample(ref, place + step * (static_cast<float>(i) - 0.5f * static_cast<float>(taps - 1)), level);
    return sum / static_cast<float>(taps);
}

}  // namespace pentaprism
