#pragma once
// The shutter's curve as a distribution of time: samples are dense where the shutter is wide open, and all weigh the
// same.

#include <pentaprism/settings.h>
#include <vector>

namespace pentaprism {

class ShutterCurve {
  public:
    ShutterCurve() = default;  ///< open all the time

    /// Points as in ShutterSettings::curve, validated.
    explicit ShutterCurve(std::vector<ShutterPoint> points);

    bool is_box() const { return points_.empty(); }

    /// The time before which `share` of the light has come in, both in [0, 1]. Does not fall when the share grows.
    double time_of(double share) const;

  private:
    std::vector<ShutterPoint> points_;
    std::vector<double> light_;  // until each point
};

}  // namespace pentaprism
