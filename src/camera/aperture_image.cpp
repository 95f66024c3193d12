#include "camera/aperture_image.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <pentaprism/error.h>
#include <pentaprism/image.h>

namespace pentaprism {
namespace {

// Whole inside the unit disk: its corner that is farthest from the middle.
bool is_in_lens(int column, int row, int width, int height) {
    const auto farther = [](int i, int n) {
        return std::max(std::abs(2.0 * i / n - 1.0), std::abs(2.0 * (i + 1) / n - 1.0));
    };
    return std::hypot(farther(column, width), farther(row, height)) <= 1.0;
}

// The place in [0, count) at which the cumulated light is `share`, within a cell by its own share.
double place_of(const double* cumulated, int count, double share) {
    const double* above = std::upper_bound(cumulated, cumulated + count + 1, share);
    const int cell = std::clamp(static_cast<int>(above - cumulated) - 1, 0, count - 1);
    const double light = cumulated[cell + 1] - cumulated[cell];
    return cell + (light > 0.0 ? std::clamp((share - cumulated[cell]) / light, 0.0, 1.0) : 0.5);
}

void to_shares(double* cumulated, int count) {
    const double all = cumulated[count];
    for (int i = 0; i <= count; ++i) cumulated[i] = all > 0.0 ? cumulated[i] / all : static_cast<double>(i) / count;
}

}  // namespace

ApertureImage::ApertureImage(int width, int height, const std::vector<float>& luminance, const std::string& name)
    : width_(width), height_(height), rows_(height + 1, 0.0), columns_(std::size_t(width + 1) * height, 0.0) {
    for (int y = 0; y < height; ++y) {
        double* row = &columns_[std::size_t(width + 1) * y];
        for (int x = 0; x < width; ++x) {
            const float light = luminance[std::size_t(width) * y + x];
            row[x + 1] =
                row[x] + (std::isfinite(light) && light > 0.0f && is_in_lens(x, y, width, height) ? light : 0.0);
        }
        rows_[y + 1] = rows_[y] + row[width];
        to_shares(row, width);
    }
    if (!(rows_[height] > 0.0))
        throw Error(ErrorKind::kUsage,
                    fmt::format("--aperture-image {}: no light comes through; it is black within its circle", name));
    to_shares(rows_.data(), height);
}

glm::dvec2 ApertureImage::point(double p, double q) const {
    const double y = place_of(rows_.data(), height_, q);
    const int row = std::min(static_cast<int>(y), height_ - 1);
    const double x = place_of(&columns_[std::size_t(width_ + 1) * row], width_, p);
    return {2.0 * x / width_ - 1.0, 1.0 - 2.0 * y / height_};
}

ApertureImage read_aperture_image(const std::string& file) {
    Picture picture;
    try {
        picture = read_picture(file);
    } catch (const Error& error) {
        throw Error(ErrorKind::kUsage, fmt::format("--aperture-image {}", error.what()));
    }
    std::vector<float> luminance;
    luminance.reserve(picture.rgba.size() / 4);
    for (std::size_t i = 0; i + 3 < picture.rgba.size(); i += 4)
        luminance.push_back(picture.rgba[i + 3] * (0.2126f * picture.rgba[i] + 0.7152f * picture.rgba[i + 1] +
                                                   0.0722f * picture.rgba[i + 2]));
    return ApertureImage(picture.width, picture.height, luminance, file);
}

}  // namespace pentaprism
