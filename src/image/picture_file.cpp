// Which writer or reader a file's suffix asks for, and the rules that both writers hold their caller to.

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <pentaprism/error.h>
#include <pentaprism/image.h>

#include "image/part_file.h"
#include "image/writers.h"

namespace pentaprism {
namespace {

std::string lower_suffix(const std::filesystem::path& file) {
    std::string suffix = file.extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return suffix;
}

[[noreturn]] void refuse(const std::string& file, const std::string& what) {
    throw Error(ErrorKind::kRender, fmt::format("{}: broken row order: {}", file, what));
}

}  // namespace

bool is_picture_name(const std::filesystem::path& file) {
    const std::string suffix = lower_suffix(file);
    return suffix == ".exr" || suffix == ".png";
}

bool is_exr_name(const std::filesystem::path& file) {
    return lower_suffix(file) == ".exr";
}

std::unique_ptr<PictureWriter> make_picture_writer(const std::filesystem::path& file, const ImageSettings& image,
                                                   const FileMetadata& metadata) {
    const std::string suffix = lower_suffix(file);
    if (suffix == ".exr") return make_exr_writer(file, metadata);
    if (suffix == ".png") return make_png_writer(file, image, metadata);
    throw Error(ErrorKind::kUsage, fmt::format("{}: a picture's name ends in .exr or .png", file.string()));
}

Picture read_picture(const std::filesystem::path& file) {
    const std::string suffix = lower_suffix(file);
    if (suffix == ".exr") return read_exr(file);
    if (suffix == ".png") return read_png(file);
    throw Error(ErrorKind::kScene, fmt::format("{}: only .exr and .png pictures can be read", file.string()));
}

FileMetadata read_metadata(const std::filesystem::path& file) {
    const std::string suffix = lower_suffix(file);
    if (suffix == ".exr") return read_exr_metadata(file);
    if (suffix == ".png") return read_png_metadata(file);
    throw Error(ErrorKind::kScene, fmt::format("{}: only .exr and .png pictures can be read", file.string()));
}

void write_text_file(const std::filesystem::path& file, std::string_view text) {
    PartFile part(file);
    part.write(text.data(), text.size());
    part.commit();
}

void RowOrder::begin(const FrameInfo& info, const std::filesystem::path& file) {
    file_ = file.string();
    if (end_ >= 0) refuse(file_, "the frame begins twice");
    if (info.x0 < 0 || info.y0 < 0 || info.x0 >= info.x1 || info.y0 >= info.y1 || info.x1 > info.width ||
        info.y1 > info.height) {
        refuse(file_, fmt::format("part {},{},{},{} of a picture of {}x{}", info.x0, info.x1, info.y0, info.y1,
                                  info.width, info.height));
    }
    width_ = info.x1 - info.x0;
    next_ = info.y0;
    end_ = info.y1;
}

void RowOrder::take(const PixelRows& band) {
    const auto pixels = static_cast<std::size_t>(std::max(0, band.count)) * static_cast<std::size_t>(width_);
    if (band.y0 != next_ || band.count < 0 || band.y0 + band.count > end_) {
        refuse(file_, fmt::format("rows {} to {} where row {} is due", band.y0, band.y0 + band.count - 1, next_));
    }
    if (band.width != width_ || band.rgba.size() < 4 * pixels || band.z.size() < pixels) {
        refuse(file_, fmt::format("a band of width {} for a picture of width {}", band.width, width_));
    }
    next_ += band.count;
}

void RowOrder::finish() const {
    if (next_ != end_) refuse(file_, fmt::format("the rows end at {} of {}", next_, end_));
}

}  // namespace pentaprism
