#include "image/tone_curve.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pentaprism {
namespace {

float narkowicz(float x) {
    return x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f);
}

float hable_curve(float x) {
    constexpr float kShoulder = 0.15f, kLinear = 0.50f, kAngle = 0.10f, kToe = 0.20f, kToeNumerator = 0.02f,
                    kToeDenominator = 0.30f;
    return (x * (kShoulder * x + kAngle * kLinear) + kToe * kToeNumerator) /
               (x * (kShoulder * x + kLinear) + kToe * kToeDenominator) -
           kToeNumerator / kToeDenominator;
}

float hable(float x) {
    constexpr float kExposureBias = 2.0f, kWhite = 11.2f;
    return hable_curve(kExposureBias * x) / hable_curve(kWhite);
}

// Step k is where 255 * srgb passes k + 1/2.
std::array<float, 255> make_steps() {
    std::array<float, 255> steps{};
    for (int k = 0; k < 255; ++k) steps[k] = static_cast<float>(srgb_decode((k + 0.5) / 255.0));
    return steps;
}

}  // namespace

double srgb_encode(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

double srgb_decode(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

float tone_map(ToneMap curve, float linear) {
    if (!(linear > 0.0f)) return 0.0f;
    // Past this every curve is at its end, and none of them has met infinity / infinity.
    const float x = std::min(linear, 1e6f);
    switch (curve) {
        case ToneMap::kAces:
            return std::clamp(narkowicz(x), 0.0f, 1.0f);
        case ToneMap::kFilmic:
            return std::clamp(hable(x), 0.0f, 1.0f);
        case ToneMap::kNone:
            break;
    }
    return std::min(x, 1.0f);
}

std::uint8_t to_srgb8(float display) {
    static const std::array<float, 255> steps = make_steps();
    return static_cast<std::uint8_t>(std::upper_bound(steps.begin(), steps.end(), display) - steps.begin());
}

}  // namespace pentaprism
