#include "scene/image_decode.h"

#include <fmt/format.h>
#include <limits>
#include <memory>
#include <stb_image.h>

namespace pentaprism {

namespace {

/// 2^27 texels are half a gigabyte: more is a mistake or an attack.
constexpr std::int64_t kMostTexels = std::int64_t{1} << 27;

}  // namespace

bool decode_image(std::span<const std::uint8_t> bytes, Image& image, std::string& problem) {
    if (bytes.empty() || bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        problem = fmt::format("has {} bytes", bytes.size());
        return false;
    }
    const int size = static_cast<int>(bytes.size());
    int width = 0, height = 0, channels = 0;
    if (stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) == 0) {
        problem = "is of an unknown kind or broken";
        return false;
    }
    if (width <= 0 || height <= 0 || std::int64_t{width} * height > kMostTexels) {
        problem = fmt::format("has {} x {} texels", width, height);
        return false;
    }
    const std::unique_ptr<stbi_uc, void (*)(void*)> texels(
        stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, STBI_rgb_alpha), stbi_image_free);
    if (texels == nullptr) {
        const char* reason = stbi_failure_reason();
        problem = fmt::format("cannot be decoded ({})", reason != nullptr ? reason : "unknown reason");
        return false;
    }
    image.width = width;
    image.height = height;
    image.texels.assign(texels.get(), texels.get() + std::size_t(width) * std::size_t(height) * 4);
    return true;
}

bool read_hdr(const std::string& file, int& width, int& height, std::vector<float>& rgb, std::string& problem) {
    int channels = 0;
    if (stbi_info(file.c_str(), &width, &height, &channels) == 0 || stbi_is_hdr(file.c_str()) == 0) {
        problem = "it does not exist or is no Radiance .hdr picture";
        return false;
    }
    if (width <= 0 || height <= 0 || std::int64_t{width} * height > kMostTexels / 2) {
        problem = fmt::format("it has {} x {} pixels", width, height);
        return false;
    }
    const std::unique_ptr<float, void (*)(void*)> pixels(stbi_loadf(file.c_str(), &width, &height, &channels, 3),
                                                         stbi_image_free);
    if (!pixels) {
        problem = fmt::format("it cannot be read ({})", stbi_failure_reason());
        return false;
    }
    rgb.assign(pixels.get(), pixels.get() + 3 * static_cast<std::size_t>(width) * height);
    return true;
}

}  // namespace pentaprism
