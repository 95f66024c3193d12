#pragma once
// When a sample looks: its stratified time is warped by the shutter's curve, and a rolling shutter delays it by where
// in the picture it lies. Both are pure functions of the sample, in double, so that all code paths have the same time.

#include <cstdint>

#include "camera/view.h"

namespace pentaprism {

class SampleTimes {
  public:
    SampleTimes() = default;  ///< open all the time, everywhere at once
    SampleTimes(const Shutter& shutter, int width, int height);

    bool roll() const { return rolling_ != RollingShutter::kNone; }

    /// Time within the exposure of a row, `tick` * 2^-24 of whose light came in before. A multiple of 2^-24 below 1.
    float within_exposure(std::uint32_t tick) const;

    /// Time of the whole shutter of a sample at (x, y) pixels from the picture's top left corner, y down, whose time
    /// within the exposure is t. A multiple of 2^-24 below 1. Without a rolling shutter: t.
    float at(float t, double x, double y) const;

    /// Times that at() may give for t in [t0, t1] and places in [x0, x1] x [y0, y1], a little wider.
    struct Range {
        float t0, t1;
    };
    Range range(float t0, float t1, double x0, double x1, double y0, double y1) const;

  private:
    double delay(double x, double y) const;  // of the readout, 0 to 1

    ShutterCurve curve_;
    RollingShutter rolling_ = RollingShutter::kNone;
    double width_ = 1.0, height_ = 1.0, exposure_share_ = 1.0;
};

}  // namespace pentaprism
