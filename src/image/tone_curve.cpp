#include "image/tone_curve.h"

#include <algorithm>
#include <bit>
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

// Where 255 * srgb passes k + 1/2, and from which k to look on: known for each 64th of an octave, in which the curve
// steps at most twice.
class SrgbSteps {
  public:
    SrgbSteps() {
        for (int k = 0; k < 255; ++k) steps_[k] = static_cast<float>(srgb_decode((k + 0.5) / 255.0));
        for (std::uint32_t i = 0; i < kIntervals; ++i) {
            const float least = std::bit_cast<float>(kLeastBits + (i << kShift));
            first_[i] = static_cast<std::uint8_t>(std::upper_bound(steps_, steps_ + 255, least) - steps_);
        }
    }
    std::uint8_t code(float display) const {
        if (!(display >= kLeast)) return 0;
        const std::uint32_t interval = (std::bit_cast<std::uint32_t>(display) - kLeastBits) >> kShift;
        std::uint8_t k = first_[std::min(interval, kIntervals - 1)];
        while (k < 255 && steps_[k] <= display) ++k;
        return k;
    }

  private:
    static constexpr float kLeast = 0x1p-13f;  // before the first step
    static constexpr std::uint32_t kLeastBits = std::bit_cast<std::uint32_t>(kLeast), kShift = 17,
                                   kIntervals = (13 << 6) + 1;
    float steps_[255];
    std::uint8_t first_[kIntervals];
};

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
    static const SrgbSteps steps;
    return steps.code(display);
}

}  // namespace pentaprism
