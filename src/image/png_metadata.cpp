// The texts that png_file.cpp writes into a PNG, read back by libpng. libpng reports errors by longjmp, which must not
// skip a C++ destructor: read_texts() has none.

#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <memory>
#include <pentaprism/error.h>
#include <png.h>

#include "image/writers.h"

namespace pentaprism {
namespace {

struct Reader {
    Reader() {
        png = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, [](png_structp, png_const_charp) {});
        info = png ? png_create_info_struct(png) : nullptr;
    }
    ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    static void on_error(png_structp png, png_const_charp message) {
        auto& self = *static_cast<Reader*>(png_get_error_ptr(png));
        std::snprintf(self.message, sizeof self.message, "%s", message);
        std::longjmp(png_jmpbuf(png), 1);
    }

    png_structp png = nullptr;
    png_infop info = nullptr;
    png_textp texts = nullptr;
    int count = 0;
    char message[200] = "";
};

bool read_texts(Reader& reader, std::FILE* file) {
    if (setjmp(png_jmpbuf(reader.png))) return false;
    png_init_io(reader.png, file);
    png_read_info(reader.png, reader.info);
    png_get_text(reader.png, reader.info, &reader.texts, &reader.count);
    return true;
}

}  // namespace

FileMetadata read_png_metadata(const std::filesystem::path& file) {
    const auto close = [](std::FILE* stream) { std::fclose(stream); };
    const std::unique_ptr<std::FILE, decltype(close)> stream(std::fopen(file.c_str(), "rbe"), close);
    Reader reader;
    if (!reader.info) throw std::bad_alloc();
    if (!stream || !read_texts(reader, stream.get()))
        throw Error(ErrorKind::kScene,
                    fmt::format("{}: cannot read ({})", file.string(), stream ? reader.message : std::strerror(errno)));
    FileMetadata metadata;
    metadata.software.clear();
    for (int i = 0; i < reader.count; ++i) {
        const png_text& text = reader.texts[i];
        if (std::strcmp(text.key, "pentaprism") == 0) metadata.settings_json.assign(text.text, text.text_length);
        if (std::strcmp(text.key, "Software") == 0) metadata.software.assign(text.text, text.text_length);
    }
    return metadata;
}

}  // namespace pentaprism
