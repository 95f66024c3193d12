#pragma once
// Where rendered frames go: pictures with a name, or a folder of training data.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <pentaprism/image.h>
#include <pentaprism/render.h>
#include <string>

namespace pentaprism::cli {

/// What all frames have in common, and what their files say of it.
struct FrameSource {
    RenderSettings settings;
    std::string scene, scene_hash, software;
    FileMetadata metadata(const RenderSettings& of) const;
};

class FrameOutput {
  public:
    virtual ~FrameOutput() = default;
    /// What progress calls the frame.
    virtual std::string name(std::int64_t frame) const = 0;
    /// All its files are there, whole.
    virtual bool exists(std::int64_t frame) const = 0;
    virtual RenderStats render(Renderer& renderer, std::int64_t frame, const Progress& progress) = 0;
    /// After the last frame.
    virtual void finish() {}
};

/// `out` as the user gives it, with #### for the frame. `sharp`: with a twin beside each, a.0001.sharp.exr for
/// a.0001.exr.
std::unique_ptr<FrameOutput> make_picture_output(const FrameSource& source, const std::filesystem::path& out,
                                                 bool sharp);

/// Makes the folders. Of a frame the file frames/NNNN.json is written last: what has it is whole.
std::unique_ptr<FrameOutput> make_dataset_output(const FrameSource& source, const std::filesystem::path& folder);

/// The scene at one moment of the open shutter through a pinhole: the same geometry, camera, places of samples in their
/// pixels and seed. `info` is that of the blurred frame; the same pixels go to all `files`.
enum class SharpMoment { kOpen, kMiddle, kClose };
void render_sharp(Renderer& renderer, const FrameSource& source, const FrameInfo& info, SharpMoment moment,
                  const std::vector<std::filesystem::path>& files, const Progress& progress);

}  // namespace pentaprism::cli
