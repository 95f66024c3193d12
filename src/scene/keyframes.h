#pragma once
// One animation channel at one time (glTF 2.0, appendix C).

#include <pentaprism/scene.h>
#include <span>

namespace pentaprism {

/// The value of the channel, `channel.width` numbers. Rotations (x y z w) are unit quaternions.
void sample_channel(const Channel& channel, double time, std::span<double> out);

}  // namespace pentaprism
