#pragma once
// Settings that differ from frame to frame by chance, for training data that covers many cameras. What a frame gets
// depends on the seed and its number alone: not on which frames are rendered, in what order, or by whom.

#include <array>
#include <cstdint>
#include <optional>
#include <pentaprism/settings.h>
#include <string>

namespace pentaprism {

struct Range {
    double low = 0.0, high = 0.0;
};

/// Unset ranges leave the setting alone.
struct Randomization {
    std::uint64_t seed = 0;
    std::optional<Range> fstop;           ///< evenly in its logarithm, as stops are
    std::optional<Range> focus_distance;  ///< metres, evenly in its logarithm
    std::optional<Range> shutter;         ///< frames, evenly
    std::optional<Range> exposure;        ///< EV, evenly; added to the exposure that is set
    double camera_shift = 0.0;            ///< metres: up to so far along each of the camera's axes, either way
    double camera_turn = 0.0;             ///< degrees: up to so far about each of them
};

/// Reads a JSON object whose keys are the members above, a range as [LOW, HIGH]. Throws Error(kUsage) with the file's
/// name for what it does not understand.
Randomization read_randomization(const std::string& file);

/// The same object, for records.
std::string randomization_json(const Randomization& randomization);

/// Throws Error(kUsage) where settings and randomization ask for different things, or for something out of range.
void check_randomization(const RenderSettings& settings, const Randomization& randomization);

/// The settings of one frame. A camera's offset is the same for the whole frame: a picture on another tripod, no shake
/// while the shutter is open; flow leads to the neighbouring frames as they are rendered.
RenderSettings randomized(const RenderSettings& settings, const Randomization& randomization, std::int64_t frame);

}  // namespace pentaprism
