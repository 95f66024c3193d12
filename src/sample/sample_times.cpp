#include "sample/sample_times.h"

#include <algorithm>
#include <cmath>

namespace pentaprism {
namespace {

constexpr double kTicks = 16777216.0;

float from_ticks(double ticks) {
    return static_cast<float>(std::clamp(std::floor(ticks), 0.0, kTicks - 1.0) / kTicks);
}

}  // namespace

SampleTimes::SampleTimes(const Shutter& shutter, int width, int height)
    : curve_(shutter.curve),
      rolling_(shutter.rolling),
      width_(width),
      height_(height),
      exposure_share_(shutter.exposure_share) {}

float SampleTimes::within_exposure(std::uint32_t tick) const {
    if (curve_.is_box()) return static_cast<float>(tick) / static_cast<float>(kTicks);
    return from_ticks(curve_.time_of((tick + 0.5) / kTicks) * kTicks);
}

double SampleTimes::delay(double x, double y) const {
    switch (rolling_) {
        case RollingShutter::kTop:
            return std::clamp(y / height_, 0.0, 1.0);
        case RollingShutter::kBottom:
            return std::clamp(1.0 - y / height_, 0.0, 1.0);
        case RollingShutter::kLeft:
            return std::clamp(x / width_, 0.0, 1.0);
        case RollingShutter::kRight:
            return std::clamp(1.0 - x / width_, 0.0, 1.0);
        case RollingShutter::kNone:
            break;
    }
    return 0.0;
}

float SampleTimes::at(float t, double x, double y) const {
    if (!roll()) return t;
    return from_ticks((delay(x, y) * (1.0 - exposure_share_) + t * exposure_share_) * kTicks);
}

// at() is a sum of a monotone function of t and one of x or y, rounded down to a tick; a tick more on each side covers
// the rounding of the sum.
SampleTimes::Range SampleTimes::range(float t0, float t1, double x0, double x1, double y0, double y1) const {
    if (!roll() || t0 > t1) return {t0, t1};
    constexpr float kTick = static_cast<float>(2.0 / kTicks);
    const double here = delay(x0, y0), there = delay(x1, y1), readout = 1.0 - exposure_share_;
    const double first = std::min(here, there), last = std::max(here, there);
    return {std::max(0.0f, from_ticks((first * readout + t0 * exposure_share_) * kTicks) - kTick),
            std::min(1.0f, from_ticks((last * readout + t1 * exposure_share_) * kTicks) + kTick)};
}

}  // namespace pentaprism
