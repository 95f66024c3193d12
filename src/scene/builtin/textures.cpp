#include "scene/builtin/textures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

#include "scene/builtin/random.h"

namespace pentaprism::builtin {
namespace {

/// Fills a picture from a function of the texel centre (u right, v down, both 0 to 1): linear colour and alpha.
Image paint(std::string name, int width, int height, const std::function<glm::dvec4(double u, double v)>& texel) {
    Image image{std::move(name), width, height, {}};
    image.texels.reserve(std::size_t(4) * std::size_t(width) * std::size_t(height));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const glm::dvec4 c = glm::clamp(texel((x + 0.5) / width, (y + 0.5) / height), 0.0, 1.0);
            for (int k = 0; k < 3; ++k) image.texels.push_back(srgb_code(c[k]));
            image.texels.push_back(static_cast<std::uint8_t>(std::lround(255.0 * c.w)));
        }
    }
    return image;
}

/// 1 on a line of half width w, falling to 0 at twice that.
double line(double distance, double w) {
    return 1.0 - glm::smoothstep(w, 2.0 * w, std::abs(distance));
}

}  // namespace

std::uint8_t srgb_code(double linear) {
    const double c = std::clamp(linear, 0.0, 1.0);
    const double s = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(255.0 * s));
}

Image checker_texture(std::string name, int size, int squares, glm::dvec3 dark, glm::dvec3 light) {
    return paint(std::move(name), size, size, [&](double u, double v) {
        const bool odd = ((static_cast<int>(u * squares) + static_cast<int>(v * squares)) & 1) != 0;
        return glm::dvec4(odd ? light : dark, 1.0);
    });
}

Image stripe_texture(std::string name, int size, int stripes, glm::dvec3 dark, glm::dvec3 light) {
    return paint(std::move(name), size, size, [&](double u, double v) {
        const bool odd = (static_cast<int>((u + v) * 2 * stripes) & 1) != 0;
        return glm::dvec4(odd ? light : dark, 1.0);
    });
}

Image target_texture(std::string name, int size, int rings, glm::dvec3 dark, glm::dvec3 light) {
    return paint(std::move(name), size, size, [&](double u, double v) {
        const double r = 2.1 * glm::length(glm::dvec2(u - 0.5, v - 0.5));
        const bool odd = r < 1.0 && (static_cast<int>(r * 2 * rings) & 1) == 0;
        return glm::dvec4(odd ? light : dark, 1.0);
    });
}

Image soft_spot_texture(std::string name, glm::dvec3 color, double alpha) {
    return paint(std::move(name), 64, 64, [&](double u, double v) {
        const double x = 2.0 * u - 1.0, y = 2.0 * v - 1.0;
        const double fall =
            (1.0 - glm::smoothstep(0.45, 1.0, std::abs(x))) * (1.0 - glm::smoothstep(0.3, 1.0, std::abs(y)));
        return glm::dvec4(color, alpha * fall);
    });
}

Image bark_texture() {
    return paint("bark", 128, 256, [](double u, double v) {
        // Noise on a cylinder, cut at a meridian: mixing the two ends makes it repeat in u and in v.
        const auto furrows = [](double x, double y) { return fractal_noise({14.0 * x, 5.0 * y}, 4); };
        const double a = glm::mix(furrows(u, v), furrows(u - 1.0, v), u);
        const double b = glm::mix(furrows(u, v - 1.0), furrows(u - 1.0, v - 1.0), u);
        const double n = glm::mix(a, b, v);
        return glm::dvec4(glm::dvec3(0.25 + 0.75 * glm::smoothstep(0.25, 0.7, n)), 1.0);
    });
}

Image litter_texture() {
    constexpr int kSize = 256, kFlecks = 420;
    // Flecks, drawn one over the other; the picture repeats, so what leaves it on one side comes back on the other.
    std::vector<double> fleck_shade(std::size_t(kSize) * kSize, -1.0);
    Random random(3);
    for (int i = 0; i < kFlecks; ++i) {
        const double x = random.uniform(), y = random.uniform(), a = random.angle(), length = random.range(0.01, 0.035);
        const glm::dvec2 along{std::cos(a) / length, std::sin(a) / length};
        const double width = random.range(0.25, 0.6), shade = random.range(0.35, 1.0);
        const int reach = static_cast<int>(std::ceil(length * kSize)), cx = static_cast<int>(x * kSize),
                  cy = static_cast<int>(y * kSize);
        for (int py = cy - reach; py <= cy + reach; ++py)
            for (int px = cx - reach; px <= cx + reach; ++px) {
                const glm::dvec2 d{(px + 0.5) / kSize - x, (py + 0.5) / kSize - y};
                const double s = glm::dot(d, along), t = d.x * along.y - d.y * along.x;
                const int texel = (py & (kSize - 1)) * kSize + (px & (kSize - 1));
                if (std::abs(t) < width * (1.0 - s * s))
                    fleck_shade[std::size_t(texel)] = shade * (0.9 + 0.2 * std::abs(t));
            }
    }
    return paint("litter", kSize, kSize, [&](double u, double v) {
        const auto crumbs = [](double x, double y) { return fractal_noise({24.0 * x, 24.0 * y}, 4); };
        const double a = glm::mix(crumbs(u, v), crumbs(u - 1.0, v), u);
        const double b = glm::mix(crumbs(u, v - 1.0), crumbs(u - 1.0, v - 1.0), u);
        const double crumb = 0.35 + 0.55 * glm::smoothstep(0.3, 0.7, glm::mix(a, b, v));
        const double fleck =
            fleck_shade[std::size_t(static_cast<int>(v * kSize) * kSize + static_cast<int>(u * kSize))];
        return glm::dvec4(glm::dvec3(fleck < 0.0 ? crumb : fleck), 1.0);
    });
}

Image leaf_texture() {
    return paint("leaf", 128, 128, [](double u, double v) {
        const double x = std::abs(2.0 * u - 1.0);
        const double along = v - 0.35 * x;  // side veins rise towards the tip
        const double side = std::abs(along * 9.0 - std::round(along * 9.0)) / 9.0;
        const double veins = std::max(line(0.5 * x, 0.012), 0.55 * line(side, 0.006));
        const double mottle = 0.86 + 0.14 * fractal_noise({9.0 * u, 9.0 * v}, 3);
        return glm::dvec4(glm::dvec3(glm::mix(0.72 * mottle * (1.0 - 0.15 * x), 1.0, veins)), 1.0);
    });
}

Image wing_texture(std::string name, glm::dvec3 membrane, glm::dvec3 vein, double membrane_alpha) {
    // Cells of a jittered grid, stretched along the wing and finer towards the trailing edge, as in a dragonfly's wing.
    constexpr int kAcross = 11, kAlong = 34;
    Random random(7);
    std::vector<glm::dvec2> sites;
    for (int j = -1; j <= kAlong; ++j)
        for (int i = -1; i <= kAcross; ++i) {
            const double x = (i + 0.5 + random.around(0.0, 0.35)) / kAcross;
            const double y = (j + 0.5 * (i & 1) + 0.5 + random.around(0.0, 0.3)) / kAlong;
            sites.emplace_back(x, y);
        }
    const auto site = [&](int i, int j) { return sites[std::size_t((j + 1) * (kAcross + 2) + i + 1)]; };
    return paint(std::move(name), 128, 512, [&](double u, double v) {
        const double warped = std::pow(u, 0.75);
        const glm::dvec2 scale{1.0, 2.6}, q{warped, v};
        double nearest = 1e9, second = 1e9;
        const int ci = static_cast<int>(warped * kAcross), cj = static_cast<int>(v * kAlong);
        for (int j = std::max(-1, cj - 2); j <= std::min(kAlong, cj + 2); ++j)
            for (int i = std::max(-1, ci - 2); i <= std::min(kAcross, ci + 2); ++i) {
                const double d = glm::length(scale * (site(i, j) - q));
                if (d < nearest)
                    second = std::exchange(nearest, d);
                else
                    second = std::min(second, d);
            }
        double veins = line(0.5 * (second - nearest), 0.0045);
        for (const double main : {0.02, 0.2, 0.33, 0.52}) veins = std::max(veins, line(warped - main, 0.014));
        veins = std::max(veins, line(u - 1.0, 0.01));
        const bool stigma = v > 0.83 && v < 0.9 && warped > 0.03 && warped < 0.19;  // the dark spot near the tip
        if (stigma) veins = 1.0;
        const double shimmer = fractal_noise({4.0 * u, 10.0 * v}, 2);
        const glm::dvec3 clear = membrane * (0.8 + 0.4 * shimmer);
        return glm::dvec4(glm::mix(clear, vein, veins), glm::mix(membrane_alpha, 1.0, veins));
    });
}

}  // namespace pentaprism::builtin
