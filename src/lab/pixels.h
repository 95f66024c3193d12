#pragma once
// Small pictures for the report: PNG in memory, heat colours, sizes.

#include <cstdint>
#include <pentaprism/render.h>
#include <string>
#include <vector>

namespace pentaprism {

/// 8-bit RGB, row by row from the top.
struct Pixels {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
};

/// Throws Error(kRender) when libpng cannot.
std::vector<std::uint8_t> encode_png(const Pixels& pixels);

/// As the PNG writer shows it: ACES curve, sRGB.
Pixels displayed(const Picture& picture);

/// One number for each pixel.
struct Field {
    int width = 0, height = 0;
    std::vector<float> values;
};

/// Black at 0, then through violet, red and yellow to white at `largest`, by logarithm from `largest` / 1000 up.
Pixels heat_colours(const Field& field, float largest);

/// The colours of heat_colours() at `steps` places from 0 to 1: for a scale. "#rrggbb" each.
std::vector<std::string> heat_scale(int steps);

/// The picture in grey, half as bright, with red where values are above 0 (the more the brighter).
Pixels marked_picture(const Picture& picture, const Field& field);

std::string base64(const std::vector<std::uint8_t>& bytes);

}  // namespace pentaprism
