#pragma once
// Pictures for materials, from the bytes of a PNG, JPEG or another file format to 8-bit RGBA.

#include <cstdint>
#include <pentaprism/scene.h>
#include <span>
#include <string>
#include <vector>

namespace pentaprism {

/// False: `problem` says why; the image is left alone. 16-bit channels are reduced to 8; grey becomes RGB.
bool decode_image(std::span<const std::uint8_t> bytes, Image& image, std::string& problem);

/// Radiance (.hdr) to linear RGB floats, rows from the top. False: `problem` says why.
bool read_hdr(const std::string& file, int& width, int& height, std::vector<float>& rgb, std::string& problem);

}  // namespace pentaprism
