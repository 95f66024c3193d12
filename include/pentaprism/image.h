#pragma once
// Picture files: written row by row as they are rendered, under the name FILE.part until they are whole.

#include <filesystem>
#include <memory>
#include <pentaprism/render.h>
#include <string>
#include <string_view>

namespace pentaprism {

/// What goes into the header of an EXR file beside the FrameInfo.
struct FileMetadata {
    std::string settings_json;            ///< the full settings, with seed and scene hash; no dates, no paths
    double exposure_seconds = 0.0;        ///< 0: what FrameInfo says of the shutter
    std::string software = "pentaprism";  ///< name and version of the program
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

/// One float (or the bits of an unsigned number) for each pixel, row by row from the top.
struct DataPlane {
    std::string name;
    bool whole_number = false;
    std::span<const float> values;
};

/// Pictures of numbers. Each is written whole, as NAME.part first. Throw Error(kOutput).
/// `.exr`: one part, 32-bit channels. `.npy` (NumPy 1.0): float32 of shape (height, width), or (height, width, planes)
/// of several. `.flo` (Middlebury, Baker et al. 2011): two planes, u right and v down, pixels.
void write_data_exr(const std::filesystem::path& file, int width, int height, std::span<const DataPlane> planes,
                    const FileMetadata& metadata);
void write_npy(const std::filesystem::path& file, int width, int height, std::span<const DataPlane> planes);
void write_flo(const std::filesystem::path& file, int width, int height, const DataPlane& u, const DataPlane& v);
/// 16-bit grey `.png`: whole millimetres, 65535 for that and more, 0 where `metres` is not finite.
void write_depth_png(const std::filesystem::path& file, int width, int height, std::span<const float> metres);

/// True for a name that make_picture_writer() accepts.
bool is_picture_name(const std::filesystem::path& file);

/// True for a file that may hold output variables beside the picture.
bool is_exr_name(const std::filesystem::path& file);

/// Threads that compress EXR pictures beside the caller's, for the whole process; 0 (the default): none. Never changes
/// a byte.
void set_picture_threads(int threads);

/// Writes a text as pictures are written: whole or not at all. Throws Error(kOutput).
void write_text_file(const std::filesystem::path& file, std::string_view text);

/// Reads a `.png` (to linear) or `.exr` with channels R G B and, if present, A and Z (else alpha is 1 and Z
/// +infinity). Width and height are those of the part that was rendered; Picture::info says where it lies in the whole,
/// and what the header tells of shutter and lens. Throws Error(kScene).
Picture read_picture(const std::filesystem::path& file);

/// What a picture's header says of how it was made: settings_json and software, empty where it does not. Throws
/// Error(kScene).
FileMetadata read_metadata(const std::filesystem::path& file);

}  // namespace pentaprism
