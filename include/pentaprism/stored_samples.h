#pragma once
// A frame as its samples, each with its ray: other pictures can be made of them after rendering, without new rays and
// without bias. A sample looks through the point (u, v) of the lens at time t, whatever the lens is focused on and
// however long the shutter is open; another focus moves it on the screen, a smaller aperture and a shorter shutter
// leave some out.

#include <memory>
#include <optional>
#include <pentaprism/shard.h>

namespace pentaprism {

/// What differs from the camera that the samples were rendered with. Unset: as it was.
struct Development {
    std::optional<double> focus_distance;  ///< metres
    std::optional<double> fstop;           ///< not below the recorded one
    std::optional<double> shutter;         ///< open time in frames
    double shutter_offset = 0.0;           ///< frames from the recorded mid-shutter to the new one
    std::vector<ShutterPoint> curve;       ///< as ShutterSettings::curve, over the new open time
    RollingShutter rolling = RollingShutter::kNone;
    double rolling_duration = 0.0;  ///< frames from the first row's opening to the last's; the middle row's is as above
};

/// How the samples were asked for. Throws Error(kScene) if the file holds none.
FileMetadata read_samples_metadata(const std::filesystem::path& file);

class StoredSamples {
  public:
    /// Reads the head. Throws Error(kScene).
    explicit StoredSamples(std::unique_ptr<ByteSource> source);
    ~StoredSamples();

    const FrameInfo& info() const;
    const FileMetadata& metadata() const;
    const ImageSettings& image() const;

    /// How far samples move at most, pixels. Closer to the border the picture lacks those that would come from outside.
    double reach(const Development& development) const;

    /// Once. Throws Error(kUsage) for what the samples do not hold: a larger aperture, a time at which the shutter was
    /// not open; anything but the recorded time of a rolling shutter or one with a curve; another focus of an
    /// orthographic camera or by over 256 pixels; a smaller aperture with blades. Z is the recorded one. A pixel that
    /// keeps no sample is black, with alpha 0.
    void develop(const Development& development, RowSink& sink);

  private:
    struct Stream;
    std::unique_ptr<Stream> stream_;
};

}  // namespace pentaprism
