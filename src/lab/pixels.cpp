#include "lab/pixels.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <pentaprism/error.h>
#include <png.h>

#include "image/tone_curve.h"

namespace pentaprism {
namespace {

constexpr double kDecades = 3.0;  // of the heat scale

// A scale that grows evenly lighter, so that it can also be read in grey: places, then red, green, blue.
constexpr double kHeat[][4] = {{0.00, 0, 0, 4},     {0.15, 28, 16, 68},   {0.30, 79, 18, 123},  {0.45, 136, 34, 106},
                               {0.60, 190, 55, 82}, {0.75, 236, 102, 34}, {0.88, 251, 174, 38}, {1.00, 252, 255, 200}};

void heat_colour(double place, std::uint8_t* rgb) {
    place = std::clamp(place, 0.0, 1.0);
    std::size_t i = 1;
    while (i + 1 < std::size(kHeat) && place > kHeat[i][0]) ++i;
    const double part = (place - kHeat[i - 1][0]) / (kHeat[i][0] - kHeat[i - 1][0]);
    for (int c = 0; c < 3; ++c)
        rgb[c] = static_cast<std::uint8_t>(
            std::lround(kHeat[i - 1][c + 1] + part * (kHeat[i][c + 1] - kHeat[i - 1][c + 1])));
}

// 0 stays 0; `largest` is 1.
double heat_place(double value, double largest) {
    if (!(value > 0.0) || !(largest > 0.0)) return 0.0;
    return std::max(0.0, 1.0 + std::log10(value / largest) / kDecades);
}

}  // namespace

std::vector<std::uint8_t> encode_png(const Pixels& pixels) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(pixels.width);
    image.height = static_cast<png_uint_32>(pixels.height);
    image.format = PNG_FORMAT_RGB;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    std::vector<std::uint8_t> bytes(size);
    if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.rgb.data(), 0, nullptr)) {
        const std::string why = image.message;
        png_image_free(&image);
        throw Error(ErrorKind::kRender, "a picture of the report cannot be made (" + why + ")");
    }
    bytes.resize(size);
    return bytes;
}

Pixels displayed(const Picture& picture) {
    Pixels pixels{picture.width, picture.height, {}};
    const std::size_t count = static_cast<std::size_t>(picture.width) * picture.height;
    pixels.rgb.resize(3 * count);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            pixels.rgb[3 * i + c] = to_srgb8(tone_map(ToneMap::kAces, picture.rgba[4 * i + c]));
    return pixels;
}

Pixels heat_colours(const Field& field, float largest) {
    Pixels pixels{field.width, field.height, std::vector<std::uint8_t>(3 * field.values.size())};
    for (std::size_t i = 0; i < field.values.size(); ++i)
        heat_colour(heat_place(field.values[i], largest), &pixels.rgb[3 * i]);
    return pixels;
}

std::vector<std::string> heat_scale(int steps) {
    std::vector<std::string> colours;
    for (int i = 0; i < steps; ++i) {
        std::uint8_t rgb[3];
        heat_colour(static_cast<double>(i) / std::max(1, steps - 1), rgb);
        colours.push_back(fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]));
    }
    return colours;
}

Pixels marked_picture(const Picture& picture, const Field& field) {
    Pixels pixels = displayed(picture);
    for (std::size_t i = 0; i < field.values.size(); ++i) {
        std::uint8_t* rgb = &pixels.rgb[3 * i];
        const double grey = 0.5 * (0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]);
        // The square root shows a single lost sample of a pixel, too.
        const double lost = std::sqrt(std::min(1.0f, std::max(0.0f, field.values[i])));
        const double red[3] = {255, 40, 30};
        for (int c = 0; c < 3; ++c) rgb[c] = static_cast<std::uint8_t>(std::lround(grey + (red[c] - grey) * lost));
    }
    return pixels;
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
    static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t have = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t word = static_cast<std::uint32_t>(bytes[i]) << 16;
        if (have > 1) word |= static_cast<std::uint32_t>(bytes[i + 1]) << 8;
        if (have > 2) word |= bytes[i + 2];
        for (std::size_t k = 0; k < 4; ++k) text += k <= have ? kDigits[(word >> (18 - 6 * k)) & 63] : '=';
    }
    return text;
}

}  // namespace pentaprism
