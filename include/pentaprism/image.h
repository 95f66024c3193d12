#pragma once
// Picture files: written row by row as they are rendered, under the name FILE.part until they are whole.

#include <filesystem>
#include <memory>
#include <pentaprism/render.h>
#include <string>

namespace pentaprism {

/// What goes into the header of an EXR file beside the FrameInfo.
struct FileMetadata {
    std::string settings_json;  ///< the full settings, with seed and scene hash; no dates, no paths
    double exposure_seconds = 0.0;
};

/// A sink that writes `.exr` (R G B A half, Z float, linear) or `.png` (8-bit sRGB, tone-mapped). finish() syncs and
/// renames FILE.part to FILE; a writer destroyed before that removes its .part. Throws Error(kOutput) naming the file
/// and what the system said (a full disk included), Error(kUsage) for another suffix.
class PictureWriter : public RowSink {
  public:
    virtual void finish() = 0;
};
std::unique_ptr<PictureWriter> make_picture_writer(const std::filesystem::path& file, const ImageSettings& image,
                                                   const FileMetadata& metadata);

/// Reads a `.png` (to linear) or `.exr` with channels R G B and, if present, A and Z. Throws Error(kScene).
Picture read_picture(const std::filesystem::path& file);

}  // namespace pentaprism
