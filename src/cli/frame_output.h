#pragma once
// Where rendered frames go: pictures with a name, or a folder of training data.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <pentaprism/image.h>
#include <pentaprism/metadata.h>
#include <pentaprism/randomize.h>
#include <pentaprism/render.h>
#include <pentaprism/shard.h>
#include <span>
#include <string>
#include <vector>

namespace pentaprism::cli {

/// What all frames have in common, and what their files say of it.
struct FrameSource {
    RenderSettings settings;
    std::string scene, scene_hash, software;
    std::optional<Randomization> randomization;
    PictureHashes pictures;
    /// The settings of a frame.
    RenderSettings at(std::int64_t frame) const;
    FileMetadata metadata(const RenderSettings& of) const;
};

class FrameOutput {
  public:
    virtual ~FrameOutput() = default;
    /// What progress calls the frame.
    virtual std::string name(std::int64_t frame) const = 0;
    /// All its files are there, whole.
    virtual bool exists(std::int64_t frame) const = 0;
    /// For --resume: throws Error(kUsage) for a file that is there and was made with other settings.
    virtual void check_resumable(std::span<const std::int64_t> frames) = 0;
    /// Before the first of the frames that will be rendered.
    virtual void begin(std::span<const std::int64_t>) {}
    virtual RenderStats render(Renderer& renderer, std::int64_t frame, const Progress& progress) = 0;
    /// After the last frame.
    virtual void finish() {}
};

/// `out` as the user gives it, with #### for the frame. `sharp`: with a twin beside each, a.0001.sharp.exr for
/// a.0001.exr.
std::unique_ptr<FrameOutput> make_picture_output(const FrameSource& source, const std::filesystem::path& out,
                                                 bool sharp);

/// Makes the folders. Of a frame the file frames/NNNN.json is written last: what has it is whole. `frames`: all, those
/// of other shards as well. `shard`: others write into the folder at the same time.
std::unique_ptr<FrameOutput> make_dataset_output(const FrameSource& source, const std::filesystem::path& folder,
                                                 const std::vector<std::int64_t>& frames,
                                                 const std::optional<Shard>& shard);

/// Part of the frame `out`, as a file beside it.
std::unique_ptr<FrameOutput> make_shard_output(const FrameSource& source, const std::filesystem::path& out,
                                               const Shard& shard);

/// All samples of each frame, for `refocus` and `retime`.
std::unique_ptr<FrameOutput> make_samples_output(const FrameSource& source, const std::filesystem::path& out);

/// The whole frame `out` by MPI processes together; the first one writes it.
struct Ranks;
std::unique_ptr<FrameOutput> make_ranks_output(const FrameSource& source, const std::filesystem::path& out,
                                               const Ranks& ranks);

/// a.exr.2-of-4.shard of a.exr.
std::filesystem::path shard_name(const std::filesystem::path& picture, const Shard& shard);
/// "2/4". Throws Error(kUsage).
Shard parse_shard(const std::string& text);
/// Every count-th of them.
std::vector<std::int64_t> frames_of(const std::vector<std::int64_t>& frames, const Shard& shard);

/// The scene at one moment of the open shutter through a pinhole: the same geometry, camera, places of samples in their
/// pixels and seed. Without output variables.
RenderSettings sharp_settings(RenderSettings blurred);
enum class SharpMoment { kOpen, kMiddle, kClose };
/// The number of the frame whose middle that moment is. `info` is that of the blurred frame.
double moment_of(const FrameInfo& info, SharpMoment moment);

}  // namespace pentaprism::cli
