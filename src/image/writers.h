#pragma once
// The two kinds of PictureWriter, and what they share.

#include <pentaprism/image.h>

namespace pentaprism {

std::unique_ptr<PictureWriter> make_exr_writer(const std::filesystem::path& file, const FileMetadata& metadata);
std::unique_ptr<PictureWriter> make_png_writer(const std::filesystem::path& file, const ImageSettings& image,
                                               const FileMetadata& metadata);

Picture read_exr(const std::filesystem::path& file);
Picture read_png(const std::filesystem::path& file);

FileMetadata read_exr_metadata(const std::filesystem::path& file);
FileMetadata read_png_metadata(const std::filesystem::path& file);

/// Sees to it that a frame arrives as RowSink says: begun once, bands from top to bottom without a gap, none missing.
class RowOrder {
  public:
    void begin(const FrameInfo& info, const std::filesystem::path& file);
    void take(const PixelRows& band);
    void finish() const;
    int width() const { return width_; }

  private:
    std::string file_;
    int width_ = 0, next_ = 0, end_ = -1;
};

}  // namespace pentaprism
