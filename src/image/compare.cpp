// RMSE, PSNR, SSIM and FLIP.
//
// Wang, Bovik, Sheikh, Simoncelli 2004 (SSIM: Gaussian window of 11 pixels, sigma 1.5; K 0.01 and 0.03; here on luma,
// and windows at the border use what is inside the picture). Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom,
// Fairchild 2020 (FLIP, LDR): contrast sensitivity filters, Hunt-adjusted HyAB distance, edges and points; the
// constants are the paper's.

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <numbers>
#include <pentaprism/compare.h>
#include <pentaprism/error.h>

#include "base/parallel.h"

namespace pentaprism {
namespace {

constexpr double kPixelsPerDegree = 67.0;  // a 4K screen, 0.7 m wide, seen from 0.7 m

struct Plane {
    int width, height;
    std::vector<float> values;
    Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * h) {}
    float at(int x, int y) const { return values[static_cast<std::size_t>(y) * width + x]; }
};

float encoded(float linear) {
    const float x = std::clamp(linear, 0.0f, 1.0f);
    return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
}

float decoded(float x) {
    return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

void each_row(int height, const std::function<void(int)>& body) {
    parallel_for(static_cast<std::size_t>(height), [&](std::size_t y) { body(static_cast<int>(y)); });
}

Plane map(const Plane& a, const Plane& b, float (*f)(float, float)) {
    Plane out(a.width, a.height);
    for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] = f(a.values[i], b.values[i]);
    return out;
}

// Weights for the offsets -radius .. radius.
struct Kernel {
    int radius;
    std::vector<float> weights;
};

enum class Border { kRepeatEdge, kInsideOnly };

// Along x, then along y.
Plane filtered(const Plane& in, const Kernel& across, const Kernel& down, Border border = Border::kRepeatEdge) {
    const auto pass = [border](const Plane& from, const Kernel& kernel, bool horizontal) {
        Plane to(from.width, from.height);
        const int n = horizontal ? from.width : from.height;
        each_row(from.height, [&](int y) {
            for (int x = 0; x < from.width; ++x) {
                double sum = 0.0, weights = 0.0;
                for (int k = -kernel.radius; k <= kernel.radius; ++k) {
                    int i = (horizontal ? x : y) + k;
                    if (border == Border::kInsideOnly && (i < 0 || i >= n)) continue;
                    i = std::clamp(i, 0, n - 1);
                    const double weight = kernel.weights[k + kernel.radius];
                    sum += weight * (horizontal ? from.at(i, y) : from.at(x, i));
                    weights += weight;
                }
                if (border == Border::kInsideOnly) sum /= weights;
                to.values[static_cast<std::size_t>(y) * from.width + x] = static_cast<float>(sum);
            }
        });
        return to;
    };
    return pass(pass(in, across, true), down, false);
}

Kernel sampled(int radius, const std::function<double(double)>& f) {
    Kernel kernel{radius, {}};
    for (int k = -radius; k <= radius; ++k) kernel.weights.push_back(static_cast<float>(f(k)));
    return kernel;
}

// Positive weights sum to 1, and so do negative ones.
void normalize(Kernel& kernel) {
    double positive = 0.0, negative = 0.0;
    for (const float w : kernel.weights) (w > 0.0f ? positive : negative) += w;
    for (float& w : kernel.weights) w = static_cast<float>(w > 0.0f ? w / positive : w / -negative);
}

double mean_ssim(const Plane& a, const Plane& b) {
    Kernel window = sampled(5, [](double x) { return std::exp(-x * x / (2.0 * 1.5 * 1.5)); });
    normalize(window);
    const auto mean = [&](const Plane& p) { return filtered(p, window, window, Border::kInsideOnly); };
    const auto product = [](float x, float y) { return x * y; };
    const Plane ma = mean(a), mb = mean(b);
    const Plane aa = mean(map(a, a, product)), bb = mean(map(b, b, product)), ab = mean(map(a, b, product));
    constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
    double sum = 0.0;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        const double x = ma.values[i], y = mb.values[i];
        const double xx = aa.values[i] - x * x, yy = bb.values[i] - y * y, xy = ab.values[i] - x * y;
        sum += (2.0 * x * y + c1) * (2.0 * xy + c2) / ((x * x + y * y + c1) * (xx + yy + c2));
    }
    return sum / static_cast<double>(a.values.size());
}

using Color = std::array<double, 3>;
constexpr Color kWhite = {0.950428545, 1.0, 1.088900371};  // D65

Color to_xyz(const Color& c) {
    return {0.4123907993 * c[0] + 0.3575843394 * c[1] + 0.1804807884 * c[2],
            0.2126390059 * c[0] + 0.7151686788 * c[1] + 0.0721923154 * c[2],
            0.0193308187 * c[0] + 0.1191947798 * c[1] + 0.9505321522 * c[2]};
}

// YCxCz: an opponent space linear in light, in which contrast sensitivity is known.
Color to_opponent(const Color& linear) {
    const Color xyz = to_xyz(linear);
    const double x = xyz[0] / kWhite[0], y = xyz[1] / kWhite[1], z = xyz[2] / kWhite[2];
    return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

Color to_linear(const Color& opponent) {
    const double y = (opponent[0] + 16.0) / 116.0;
    const Color xyz = {(y + opponent[1] / 500.0) * kWhite[0], y * kWhite[1], (y - opponent[2] / 200.0) * kWhite[2]};
    const auto one = [](double v) { return std::clamp(v, 0.0, 1.0); };
    return {one(3.2409699419 * xyz[0] - 1.5373831776 * xyz[1] - 0.4986107603 * xyz[2]),
            one(-0.9692436363 * xyz[0] + 1.8759675015 * xyz[1] + 0.0415550574 * xyz[2]),
            one(0.0556300797 * xyz[0] - 0.2039769589 * xyz[1] + 1.0569715142 * xyz[2])};
}

// CIELAB with chroma that shrinks with lightness (Hunt).
Color to_hunt(const Color& linear) {
    const Color xyz = to_xyz(linear);
    const auto f = [](double t) {
        constexpr double d = 6.0 / 29.0;
        return t > d * d * d ? std::cbrt(t) : t / (3.0 * d * d) + 4.0 / 29.0;
    };
    const double x = f(xyz[0] / kWhite[0]), y = f(xyz[1] / kWhite[1]), z = f(xyz[2] / kWhite[2]);
    const double lightness = 116.0 * y - 16.0;
    return {lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)};
}

double hyab(const Color& a, const Color& b) {
    return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

// Sums of two Gaussians for the three opponent channels: a1, b1, a2, b2.
constexpr double kSensitivity[3][4] = {{1.0, 0.0047, 0.0, 1e-5}, {1.0, 0.0053, 0.0, 1e-5}, {34.1, 0.04, 13.5, 0.025}};

Plane seen(const Plane& in, const double (&c)[4]) {
    constexpr double pi = std::numbers::pi;
    const int radius = static_cast<int>(std::ceil(3.0 * std::sqrt(0.04 / (2.0 * pi * pi)) * kPixelsPerDegree));
    // The kernel of the paper is normalized as a whole: shares of the two Gaussians by their sums over the square.
    Kernel part[2];
    double share[2];
    for (int i = 0; i < 2; ++i) {
        const double b = c[2 * i + 1];
        part[i] = sampled(radius, [&](double x) {
            const double degrees = x / kPixelsPerDegree;
            return std::exp(-pi * pi * degrees * degrees / b);
        });
        double sum = 0.0;
        for (const float w : part[i].weights) sum += w;
        share[i] = c[2 * i] * std::sqrt(pi / b) * sum * sum;
        normalize(part[i]);
    }
    Plane out = filtered(in, part[0], part[0]);
    if (share[1] == 0.0) return out;
    const Plane wide = filtered(in, part[1], part[1]);
    const double total = share[0] + share[1];
    for (std::size_t i = 0; i < out.values.size(); ++i)
        out.values[i] = static_cast<float>((share[0] * out.values[i] + share[1] * wide.values[i]) / total);
    return out;
}

std::array<Plane, 3> opponent_planes(const std::array<Plane, 3>& srgb) {
    std::array<Plane, 3> out = srgb;
    each_row(srgb[0].height, [&](int y) {
        for (int x = 0; x < srgb[0].width; ++x) {
            const std::size_t i = static_cast<std::size_t>(y) * srgb[0].width + x;
            const Color c =
                to_opponent({decoded(srgb[0].values[i]), decoded(srgb[1].values[i]), decoded(srgb[2].values[i])});
            for (int k = 0; k < 3; ++k) out[k].values[i] = static_cast<float>(c[k]);
        }
    });
    return out;
}

// How strong edges and points are: lengths of the first and of the second derivatives.
struct Features {
    Plane edges, points;
};

Features features(const Plane& achromatic) {
    const double sigma = 0.5 * 0.082 * kPixelsPerDegree;
    const int radius = static_cast<int>(std::ceil(3.0 * sigma));
    const auto gaussian = [&](double x) { return std::exp(-x * x / (2.0 * sigma * sigma)); };
    Kernel smooth = sampled(radius, gaussian);
    Kernel edge = sampled(radius, [&](double x) { return -x * gaussian(x); });
    Kernel point = sampled(radius, [&](double x) { return (x * x / (sigma * sigma) - 1.0) * gaussian(x); });
    normalize(smooth), normalize(edge), normalize(point);
    Plane y = achromatic;
    for (float& v : y.values) v = (v + 16.0f) / 116.0f;
    const auto length = [](float a, float b) { return std::hypot(a, b); };
    return {map(filtered(y, edge, smooth), filtered(y, smooth, edge), length),
            map(filtered(y, point, smooth), filtered(y, smooth, point), length)};
}

std::vector<float> flip_map(const std::array<Plane, 3>& a, const std::array<Plane, 3>& b) {
    constexpr double qc = 0.7, pc = 0.4, pt = 0.95;
    const double most = std::pow(hyab(to_hunt({0.0, 1.0, 0.0}), to_hunt({0.0, 0.0, 1.0})), qc);
    const std::array<Plane, 3> oa = opponent_planes(a), ob = opponent_planes(b);
    const Features fa = features(oa[0]), fb = features(ob[0]);
    std::array<Plane, 3> sa = oa, sb = ob;
    for (int k = 0; k < 3; ++k) {
        sa[k] = seen(oa[k], kSensitivity[k]);
        sb[k] = seen(ob[k], kSensitivity[k]);
    }
    std::vector<float> out(a[0].values.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
        const Color ca = to_hunt(to_linear({sa[0].values[i], sa[1].values[i], sa[2].values[i]}));
        const Color cb = to_hunt(to_linear({sb[0].values[i], sb[1].values[i], sb[2].values[i]}));
        const double d = std::pow(hyab(ca, cb), qc);
        const double color =
            d < pc * most ? pt / (pc * most) * d : pt + (d - pc * most) / (most - pc * most) * (1.0 - pt);
        const double feature = std::max(std::abs(fa.edges.values[i] - fb.edges.values[i]),
                                        std::abs(fa.points.values[i] - fb.points.values[i]));
        const double strength = std::sqrt(std::min(1.0, feature * std::numbers::sqrt2 * 0.5));
        out[i] = static_cast<float>(std::pow(std::min(color, 1.0), 1.0 - strength));
    }
    return out;
}

void check_sizes(const Picture& a, const Picture& b) {
    if (a.width != b.width || a.height != b.height)
        throw Error(ErrorKind::kUsage,
                    fmt::format("the pictures differ in size: {}x{} and {}x{}", a.width, a.height, b.width, b.height));
    if (a.width <= 0 || a.height <= 0) throw Error(ErrorKind::kUsage, "the pictures are empty");
}

// NaN to black; infinities are cut by the encoding.
float cleaned(float x) {
    return std::isnan(x) ? 0.0f : x;
}

std::array<Plane, 3> encoded_planes(const Picture& picture) {
    std::array<Plane, 3> planes = {Plane(picture.width, picture.height), Plane(picture.width, picture.height),
                                   Plane(picture.width, picture.height)};
    for (std::size_t i = 0; i < planes[0].values.size(); ++i)
        for (int k = 0; k < 3; ++k) planes[k].values[i] = encoded(cleaned(picture.rgba[4 * i + k]));
    return planes;
}

Plane luma(const std::array<Plane, 3>& c) {
    Plane out(c[0].width, c[0].height);
    for (std::size_t i = 0; i < out.values.size(); ++i)
        out.values[i] = 0.2126f * c[0].values[i] + 0.7152f * c[1].values[i] + 0.0722f * c[2].values[i];
    return out;
}

}  // namespace

Comparison compare_pictures(const Picture& a, const Picture& b, const CompareOptions& options) {
    check_sizes(a, b);
    Comparison result;
    result.width = a.width;
    result.height = a.height;
    const std::array<Plane, 3> ea = encoded_planes(a), eb = encoded_planes(b);
    double sum = 0.0;
    const std::size_t pixels = static_cast<std::size_t>(a.width) * a.height;
    for (std::size_t i = 0; i < pixels; ++i)
        for (int k = 0; k < 3; ++k) {
            const float x = a.rgba[4 * i + k], y = b.rgba[4 * i + k];
            double difference = std::abs(static_cast<double>(ea[k].values[i]) - eb[k].values[i]);
            if (!std::isfinite(x) || !std::isfinite(y)) {
                const bool same = x == y || (std::isnan(x) && std::isnan(y));
                result.not_finite += same ? 0 : 1;
                difference = same ? 0.0 : 1.0;
            } else if (options.linear) {
                difference = std::abs(static_cast<double>(x) - y);
            }
            sum += difference * difference;
            result.max = std::max(result.max, difference);
        }
    result.rmse = std::sqrt(sum / (3.0 * static_cast<double>(pixels)));
    result.psnr = -20.0 * std::log10(result.rmse);
    result.ssim = mean_ssim(luma(ea), luma(eb));
    result.flip_map = flip_map(ea, eb);
    double total = 0.0;
    for (const float value : result.flip_map) total += value;
    result.flip = total / static_cast<double>(pixels);
    return result;
}

Picture difference_picture(const Picture& a, const Picture& b, double gain) {
    check_sizes(a, b);
    const std::array<Plane, 3> ea = encoded_planes(a), eb = encoded_planes(b);
    Picture out;
    out.width = out.info.width = out.info.x1 = a.width;
    out.height = out.info.height = out.info.y1 = a.height;
    const std::size_t pixels = static_cast<std::size_t>(a.width) * a.height;
    out.z.assign(pixels, std::numeric_limits<float>::infinity());
    out.rgba.resize(4 * pixels, 1.0f);
    for (std::size_t i = 0; i < pixels; ++i)
        for (int k = 0; k < 3; ++k)
            out.rgba[4 * i + k] =
                decoded(std::min(1.0f, static_cast<float>(gain) * std::abs(ea[k].values[i] - eb[k].values[i])));
    return out;
}

}  // namespace pentaprism
