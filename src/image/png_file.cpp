// 8-bit sRGB by libpng, row by row. libpng reports errors by longjmp, which must not skip a C++ destructor: every call
// goes through PngStruct::call(), whose frame holds none, and comes out as an exception.

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <limits>
#include <new>
#include <pentaprism/error.h>
#include <png.h>

#include "base/parallel.h"
#include "image/part_file.h"
#include "image/tone_curve.h"
#include "image/writers.h"

namespace pentaprism {
namespace {

class PngStruct {
  public:
    explicit PngStruct(PartFile& file) : file_(file) {
        png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
        if (!png_) throw std::bad_alloc();
        info_ = png_create_info_struct(png_);
        if (!info_) {
            png_destroy_write_struct(&png_, nullptr);
            throw std::bad_alloc();
        }
        png_set_write_fn(png_, this, on_write, on_flush);
    }
    ~PngStruct() { png_destroy_write_struct(&png_, &info_); }
    PngStruct(const PngStruct&) = delete;
    PngStruct& operator=(const PngStruct&) = delete;

    /// body(png, info) may call libpng and nothing that has a destructor.
    template <class Body>
    void call(const Body& body) {
        if (!protected_call(body)) {
            file_.throw_if_failed();
            throw Error(ErrorKind::kOutput, fmt::format("{}: cannot write ({})", file_.name().string(), message_));
        }
    }

  private:
    template <class Body>
    bool protected_call(const Body& body) {
        if (setjmp(png_jmpbuf(png_))) return false;
        body(png_, info_);
        return true;
    }

    static void on_error(png_structp png, png_const_charp message) {
        auto& self = *static_cast<PngStruct*>(png_get_error_ptr(png));
        std::snprintf(self.message_, sizeof self.message_, "%s", message);
        std::longjmp(png_jmpbuf(png), 1);
    }
    static void on_warning(png_structp, png_const_charp) {}
    static void on_flush(png_structp) {}
    static void on_write(png_structp png, png_bytep bytes, std::size_t count) {
        auto& self = *static_cast<PngStruct*>(png_get_io_ptr(png));
        if (!self.write(bytes, count)) png_error(png, "write failed");
    }
    // The file keeps its failure, and call() throws it once libpng has been left.
    bool write(const void* bytes, std::size_t count) {
        try {
            file_.write(bytes, count);
            return true;
        } catch (const std::exception&) {
            return false;
        }
    }

    PartFile& file_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
    char message_[200] = "";
};

class PngWriter : public PictureWriter {
  public:
    PngWriter(const std::filesystem::path& file, const ImageSettings& image, const FileMetadata& metadata)
        : tonemap_(image.tonemap), metadata_(metadata), file_(file), png_(file_) {}

    void begin(const FrameInfo& info) override {
        order_.begin(info, file_.name());
        const auto width = static_cast<png_uint_32>(order_.width());
        const auto height = static_cast<png_uint_32>(info.y1 - info.y0);
        png_text texts[2] = {};
        int text_count = 0;
        add_text(texts, text_count, "Software", metadata_.software);
        add_text(texts, text_count, "pentaprism", metadata_.settings_json);
        png_.call([&](png_structp png, png_infop header) {
            png_set_IHDR(png, header, width, height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                         PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
            png_set_sRGB_gAMA_and_cHRM(png, header, PNG_sRGB_INTENT_PERCEPTUAL);
            png_set_text(png, header, texts, text_count);
            // Rendered pictures are noisy: more effort than this costs time and saves next to nothing.
            png_set_compression_level(png, 4);
            png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB | PNG_FILTER_UP);
            png_write_info(png, header);
        });
    }

    void rows(const PixelRows& band) override {
        order_.take(band);
        to_bytes(band);
        const int count = band.count;
        const std::size_t row = 3 * static_cast<std::size_t>(band.width);
        std::uint8_t* bytes = bytes_.data();
        png_.call([=](png_structp png, png_infop) {
            for (int y = 0; y < count; ++y) png_write_row(png, bytes + static_cast<std::size_t>(y) * row);
        });
    }

    void finish() override {
        order_.finish();
        png_.call([](png_structp png, png_infop header) { png_write_end(png, header); });
        file_.commit();
    }

  private:
    static void add_text(png_text* texts, int& count, const char* key, std::string& text) {
        if (text.empty()) return;
        texts[count].compression = PNG_TEXT_COMPRESSION_NONE;
        texts[count].key = const_cast<char*>(key);
        texts[count].text = text.data();
        ++count;
    }

    // Colours come over the background already (premultiplied, exposure applied), so alpha has nothing to add.
    void to_bytes(const PixelRows& band) {
        const auto width = static_cast<std::size_t>(band.width);
        bytes_.resize(3 * width * static_cast<std::size_t>(band.count));
        parallel_ranges(static_cast<std::size_t>(band.count), 4, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin * width; i < end * width; ++i) {
                for (std::size_t c = 0; c < 3; ++c) {
                    bytes_[3 * i + c] = to_srgb8(tone_map(tonemap_, band.rgba[4 * i + c]));
                }
            }
        });
    }

    ToneMap tonemap_;
    FileMetadata metadata_;
    RowOrder order_;
    std::vector<std::uint8_t> bytes_;
    PartFile file_;
    PngStruct png_;
};

}  // namespace

std::unique_ptr<PictureWriter> make_png_writer(const std::filesystem::path& file, const ImageSettings& image,
                                               const FileMetadata& metadata) {
    return std::make_unique<PngWriter>(file, image, metadata);
}

void write_depth_png(const std::filesystem::path& file, int width, int height, std::span<const float> metres) {
    std::vector<std::uint8_t> bytes(2 * metres.size());
    for (std::size_t i = 0; i < metres.size(); ++i) {
        const float millimetres = std::isfinite(metres[i]) ? std::clamp(metres[i] * 1000.0f, 0.0f, 65535.0f) : 0.0f;
        const auto value = static_cast<std::uint16_t>(std::lround(millimetres));
        bytes[2 * i] = static_cast<std::uint8_t>(value >> 8);  // PNG has the high byte first
        bytes[2 * i + 1] = static_cast<std::uint8_t>(value & 255);
    }
    PartFile part(file);
    PngStruct png(part);
    const std::uint8_t* from = bytes.data();
    png.call([=](png_structp p, png_infop header) {
        png_set_IHDR(p, header, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 16,
                     PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
        png_write_info(p, header);
        for (int y = 0; y < height; ++y) png_write_row(p, from + 2 * static_cast<std::size_t>(y) * width);
        png_write_end(p, header);
    });
    part.commit();
}

Picture read_png(const std::filesystem::path& file) {
    // libpng's simplified reader catches its own longjmp and turns any kind of PNG into 8-bit sRGB.
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    const auto fail = [&](const char* message) {
        const std::string line = fmt::format("{}: cannot read ({})", file.string(), message);
        png_image_free(&image);
        throw Error(ErrorKind::kScene, line);
    };
    if (!png_image_begin_read_from_file(&image, file.c_str())) fail(image.message);
    image.format = PNG_FORMAT_RGBA;
    std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(image));
    if (!png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr)) fail(image.message);

    Picture picture;
    picture.width = static_cast<int>(image.width);
    picture.height = static_cast<int>(image.height);
    picture.info.width = picture.info.x1 = picture.width;
    picture.info.height = picture.info.y1 = picture.height;
    picture.rgba.resize(bytes.size());
    picture.z.assign(bytes.size() / 4, std::numeric_limits<float>::infinity());
    float decoded[256];
    for (int value = 0; value < 256; ++value) decoded[value] = static_cast<float>(srgb_decode(value / 255.0));
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        picture.rgba[i] = i % 4 == 3 ? static_cast<float>(bytes[i]) / 255.0f : decoded[bytes[i]];
    }
    return picture;
}

}  // namespace pentaprism
