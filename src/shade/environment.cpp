#include "shade/environment.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <pentaprism/error.h>
#include <pentaprism/image.h>

#include "base/parallel.h"
#include "scene/image_decode.h"

namespace pentaprism {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kLevels = 6;
constexpr int kWidestSource = 1024;  // of what lights; what is seen keeps its size
constexpr float kSunContrast = 50.0f;
constexpr float kLeastSun = 0.05f;  // of all light

glm::vec3 direction_of(float u, float v) {
    const float longitude = (u - 0.5f) * 2.0f * kPi, polar = v * kPi, sine = std::sin(polar);
    return {sine * std::sin(longitude), std::cos(polar), -sine * std::cos(longitude)};
}

glm::vec3 direction_of(const Environment::Map& map, int x, int y) {
    return direction_of((static_cast<float>(x) + 0.5f) / static_cast<float>(map.width),
                        (static_cast<float>(y) + 0.5f) / static_cast<float>(map.height));
}

// Solid angle of each texel of a row.
float solid_angle(const Environment::Map& map, int y) {
    const float top = std::cos(kPi * static_cast<float>(y) / static_cast<float>(map.height));
    const float bottom = std::cos(kPi * static_cast<float>(y + 1) / static_cast<float>(map.height));
    return (top - bottom) * 2.0f * kPi / static_cast<float>(map.width);
}

float luminance(const glm::vec3& c) {
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

Environment::Map halved(const Environment::Map& fine) {
    Environment::Map coarse{std::max(1, fine.width / 2), std::max(1, fine.height / 2), {}};
    coarse.texels.resize(static_cast<std::size_t>(coarse.width) * coarse.height);
    for (int y = 0; y < coarse.height; ++y)
        for (int x = 0; x < coarse.width; ++x) {
            glm::vec3 sum(0.0f);
            float weights = 0.0f;
            for (int j = 2 * y; j < std::min(2 * y + 2, fine.height); ++j)
                for (int i = 2 * x; i < std::min(2 * x + 2, fine.width); ++i) {
                    const float weight = solid_angle(fine, j);
                    sum += weight * fine.texels[static_cast<std::size_t>(j) * fine.width + i];
                    weights += weight;
                }
            coarse.texels[static_cast<std::size_t>(y) * coarse.width + x] = sum / weights;
        }
    return coarse;
}

std::array<float, 9> basis(const glm::vec3& d) {
    return {0.282095f,
            0.488603f * d.y,
            0.488603f * d.z,
            0.488603f * d.x,
            1.092548f * d.x * d.y,
            1.092548f * d.y * d.z,
            0.315392f * (3.0f * d.z * d.z - 1.0f),
            1.092548f * d.x * d.z,
            0.546274f * (d.x * d.x - d.y * d.y)};
}

// Radical inverse in base 2.
float inverse_bits(std::uint32_t i) {
    float sum = 0.0f, digit = 0.5f;
    for (; i != 0; i >>= 1, digit *= 0.5f)
        if (i & 1) sum += digit;
    return sum;
}

// Preetham, Shirley, Smits 1999: Perez's distribution of luminance and chromaticity.
struct Perez {
    double a, b, c, d, e;
    double operator()(double cos_zenith, double angle) const {
        const double cosine = std::cos(angle);
        return (1.0 + a * std::exp(b / std::max(cos_zenith, 0.01))) *
               (1.0 + c * std::exp(d * angle) + e * cosine * cosine);
    }
};

glm::vec3 rgb_of(double x, double y, double luminance) {
    const double X = x / y * luminance, Z = (1.0 - x - y) / y * luminance;
    return glm::max(
        glm::vec3(3.2406 * X - 1.5372 * luminance - 0.4986 * Z, -0.9689 * X + 1.8758 * luminance + 0.0415 * Z,
                  0.0557 * X - 0.2040 * luminance + 1.0570 * Z),
        glm::vec3(0.0f));
}

}  // namespace

glm::vec3 Environment::Map::bilinear(const glm::vec3& direction) const {
    const float longitude = std::atan2(direction.x, -direction.z);
    const float polar = std::acos(std::clamp(direction.y, -1.0f, 1.0f));
    const float x = (longitude / (2.0f * kPi) + 0.5f) * static_cast<float>(width) - 0.5f;
    const float y = std::clamp(polar / kPi * static_cast<float>(height) - 0.5f, 0.0f, static_cast<float>(height - 1));
    const float fx = std::floor(x);
    const int i = (static_cast<int>(fx) + width) % width, j = std::min(static_cast<int>(y), height - 1);
    const int right = (i + 1) % width, below = std::min(j + 1, height - 1);
    const auto at = [&](int column, int row) -> const glm::vec3& {
        return texels[static_cast<std::size_t>(row) * width + column];
    };
    return glm::mix(glm::mix(at(i, j), at(right, j), x - fx), glm::mix(at(i, below), at(right, below), x - fx),
                    y - static_cast<float>(j));
}

Environment::Environment(Map map) : seen_(std::move(map)) {
    Map light = seen_;
    while (light.width > kWidestSource) light = halved(light);
    take_out_sun(light);
    project(light);
    filter(std::move(light));
}

// A small part of the sky that is far brighter than the mean and gives a good part of the light is a sun.
void Environment::take_out_sun(Map& map) {
    double mean = 0.0, angles = 0.0;
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            mean += solid_angle(map, y) * luminance(map.texels[static_cast<std::size_t>(y) * map.width + x]);
            angles += solid_angle(map, y);
        }
    const float limit = kSunContrast * static_cast<float>(mean / angles);
    glm::dvec3 towards(0.0), irradiance(0.0);
    double strength = 0.0;
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const glm::vec3& c = map.texels[static_cast<std::size_t>(y) * map.width + x];
            if (!(luminance(c) > limit)) continue;
            const double light = solid_angle(map, y) * luminance(c);
            towards += light * glm::dvec3(direction_of(map, x, y));
            irradiance += static_cast<double>(solid_angle(map, y)) * glm::dvec3(c) *
                          (1.0 - static_cast<double>(limit / luminance(c)));
            strength += light;
        }
    const double length = glm::length(towards);
    if (!(strength > kLeastSun * mean) || length < 0.98 * strength) return;
    sun_ = Sun{glm::vec3(towards / length), glm::vec3(irradiance)};
    for (glm::vec3& c : map.texels)
        if (luminance(c) > limit) c *= limit / luminance(c);
}

void Environment::project(const Map& map) {
    std::array<glm::dvec3, 9> sums{};
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const auto values = basis(direction_of(map, x, y));
            const glm::dvec3 light = static_cast<double>(solid_angle(map, y)) *
                                     glm::dvec3(map.texels[static_cast<std::size_t>(y) * map.width + x]);
            for (int k = 0; k < 9; ++k) sums[k] += static_cast<double>(values[k]) * light;
        }
    // The cosine's own harmonics (pi, 2 pi / 3, pi / 4), over pi.
    constexpr double kCosine[9] = {1.0, 2.0 / 3, 2.0 / 3, 2.0 / 3, 0.25, 0.25, 0.25, 0.25, 0.25};
    for (int k = 0; k < 9; ++k) harmonics_[k] = glm::vec3(kCosine[k] * sums[k]);
}

glm::vec3 Environment::matte(const glm::vec3& normal) const {
    const auto values = basis(normal);
    glm::vec3 sum(0.0f);
    for (int k = 0; k < 9; ++k) sum += values[k] * harmonics_[k];
    return glm::max(sum, glm::vec3(0.0f));
}

// Importance samples of GGX for normal = view = direction; each reads a level of the source whose texels are as large
// as its share of the sphere.
void Environment::filter(Map map) {
    constexpr int kSamples = 128;
    std::vector<Map> source{std::move(map)};
    while (source.back().width > 8) source.push_back(halved(source.back()));
    levels_.resize(kLevels);
    levels_[0] = source[0];
    for (int level = 1; level < kLevels; ++level) {
        Map& out = levels_[level];
        out.width = std::min(source[0].width, 256 >> level);
        out.height = std::max(1, out.width / 2);
        out.texels.resize(static_cast<std::size_t>(out.width) * out.height);
        const float roughness = static_cast<float>(level) / (kLevels - 1), alpha2 = std::pow(roughness, 4.0f);
        const float texel = 4.0f * kPi / (static_cast<float>(source[0].width) * static_cast<float>(source[0].height));
        parallel_for(out.height, [&](std::size_t y) {
            for (int x = 0; x < out.width; ++x) {
                const glm::vec3 n = direction_of(out, x, static_cast<int>(y));
                const glm::vec3 right = glm::normalize(
                    glm::cross(n, std::abs(n.y) < 0.9f ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(1.0f, 0.0f, 0.0f)));
                const glm::vec3 up = glm::cross(right, n);
                glm::vec3 sum(0.0f);
                float weights = 0.0f;
                for (std::uint32_t i = 0; i < kSamples; ++i) {
                    const float xi = (static_cast<float>(i) + 0.5f) / kSamples, phi = 2.0f * kPi * inverse_bits(i);
                    const float cosine = std::sqrt((1.0f - xi) / (1.0f + (alpha2 - 1.0f) * xi));
                    const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
                    const glm::vec3 half = sine * std::cos(phi) * right + sine * std::sin(phi) * up + cosine * n;
                    const glm::vec3 light = 2.0f * cosine * half - n;
                    const float weight = 2.0f * cosine * cosine - 1.0f;
                    if (!(weight > 0.0f)) continue;
                    const float base = cosine * cosine * (alpha2 - 1.0f) + 1.0f;
                    const float density = alpha2 / (4.0f * kPi * base * base);
                    const float size = std::log2(std::max(1.0f, 1.0f / (kSamples * density * texel))) * 0.5f + 0.5f;
                    const auto from = std::min(static_cast<std::size_t>(size), source.size() - 1);
                    sum += weight * source[from].bilinear(light);
                    weights += weight;
                }
                out.texels[y * out.width + x] = sum / std::max(weights, 1e-6f);
            }
        });
    }
}

glm::vec3 Environment::shiny(const glm::vec3& direction, float roughness) const {
    const float level = std::clamp(roughness, 0.0f, 1.0f) * (kLevels - 1);
    const int fine = std::min(static_cast<int>(level), kLevels - 2);
    return glm::mix(levels_[fine].bilinear(direction), levels_[fine + 1].bilinear(direction),
                    level - static_cast<float>(fine));
}

Environment Environment::sky() {
    constexpr double turbidity = 3.0;
    const glm::dvec3 sun = glm::normalize(glm::dvec3(0.5, 0.62, 0.6));
    const double zenith = std::acos(sun.y);
    const double t = turbidity, s = zenith, chi = (4.0 / 9.0 - t / 120.0) * (std::numbers::pi - 2.0 * s);
    const auto at_zenith = [&](const double(&m)[3][4]) {
        double sum = 0.0;
        for (int i = 0; i < 3; ++i)
            sum += std::pow(t, 2 - i) * (m[i][0] * s * s * s + m[i][1] * s * s + m[i][2] * s + m[i][3]);
        return sum;
    };
    const double zx = at_zenith({{0.00166, -0.00375, 0.00209, 0.0},
                                 {-0.02903, 0.06377, -0.03202, 0.00394},
                                 {0.11693, -0.21196, 0.06052, 0.25886}});
    const double zy = at_zenith({{0.00275, -0.00610, 0.00317, 0.0},
                                 {-0.04214, 0.08970, -0.04153, 0.00516},
                                 {0.15346, -0.26756, 0.06670, 0.26688}});
    const double zl = (4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192;
    const Perez luminance_of{0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
                             -0.0670 * t + 0.3703};
    const Perez x_of{-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
                     -0.0033 * t + 0.0452};
    const Perez y_of{-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
                     -0.0109 * t + 0.0529};
    // Exposed so that a white matte plane in the open is about 1; the ground is a dull brown below a soft horizon.
    constexpr double kScale = 0.035;
    constexpr glm::vec3 kGround(0.17f, 0.15f, 0.125f), kSunlight(2.75f, 2.5f, 2.15f);
    Map map{1024, 512, {}};
    map.texels.resize(std::size_t{1024} * 512);
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const glm::dvec3 d(direction_of(map, x, y));
            const double height = std::max(d.y, 0.0), angle = std::acos(std::clamp(glm::dot(d, sun), -1.0, 1.0));
            const double level = zl * luminance_of(height, angle) / luminance_of(1.0, zenith);
            const glm::vec3 sky = rgb_of(zx * x_of(height, angle) / x_of(1.0, zenith),
                                         zy * y_of(height, angle) / y_of(1.0, zenith), kScale * level);
            const float above = std::clamp(static_cast<float>(d.y) * 40.0f + 0.5f, 0.0f, 1.0f);
            map.texels[static_cast<std::size_t>(y) * map.width + x] = glm::mix(kGround, sky, above);
        }
    Environment made(std::move(map));
    made.sun_ = Sun{glm::vec3(sun), kSunlight};
    return made;
}

std::shared_ptr<const Environment> load_environment(const std::string& name) {
    if (name == "sky") return std::make_shared<const Environment>(Environment::sky());
    Environment::Map map;
    if (is_exr_name(name)) {
        const Picture picture = read_picture(name);
        map.width = picture.width;
        map.height = picture.height;
        for (std::size_t i = 0; i + 3 < picture.rgba.size(); i += 4)
            map.texels.emplace_back(picture.rgba[i], picture.rgba[i + 1], picture.rgba[i + 2]);
    } else {
        std::vector<float> rgb;
        if (std::string problem; !read_hdr(name, map.width, map.height, rgb, problem))
            throw Error(ErrorKind::kScene, fmt::format("--background {}: {}", name, problem));
        for (std::size_t i = 0; i + 2 < rgb.size(); i += 3) map.texels.emplace_back(rgb[i], rgb[i + 1], rgb[i + 2]);
    }
    if (map.width < 2 || map.height < 2)
        throw Error(ErrorKind::kScene, fmt::format("--background {}: {}x{} pixels are no picture of all directions",
                                                   name, map.width, map.height));
    for (glm::vec3& c : map.texels)
        for (int k = 0; k < 3; ++k) c[k] = std::isfinite(c[k]) ? std::clamp(c[k], 0.0f, 1e6f) : 0.0f;
    return std::make_shared<const Environment>(std::move(map));
}

}  // namespace pentaprism
