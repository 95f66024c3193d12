// Inverse of the cumulated light of a piecewise linear curve. In a piece that goes from a to b over d, light l is
// reached after x with a*x + (b - a)*x^2/(2*d) = l; of the two forms of the root, x = 2*l / (a + sqrt(a^2 + 2*(b -
// a)*l/d)) has no difference of nearly equal numbers and holds for a level piece too.

#include "camera/shutter_curve.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <pentaprism/error.h>
#include <sstream>
#include <string>
#include <string_view>

namespace pentaprism {
namespace {

/// Takes the next number off the line; false where there is none.
bool take_number(std::string_view& line, double& value) {
    const std::size_t begin = line.find_first_not_of(" \t\r,;");
    if (begin == std::string_view::npos) return false;
    const auto [end, error] = std::from_chars(line.data() + begin, line.data() + line.size(), value);
    if (error != std::errc()) return false;
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    return true;
}

}  // namespace

ShutterCurve::ShutterCurve(std::vector<ShutterPoint> points) : points_(std::move(points)) {
    double sum = 0.0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
        if (i > 0) sum += 0.5 * (points_[i].open + points_[i - 1].open) * (points_[i].t - points_[i - 1].t);
        light_.push_back(sum);
    }
}

double ShutterCurve::time_of(double share) const {
    if (is_box()) return share;
    const double wanted = share * light_.back();
    // The piece in which that much light is reached: the first point that has more, or the last piece with any.
    auto after = std::upper_bound(light_.begin(), light_.end(), wanted);
    if (after == light_.end()) after = std::lower_bound(light_.begin(), light_.end(), light_.back());
    const auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - light_.begin(), 1));
    const ShutterPoint &p = points_[i - 1], &q = points_[i];
    const double light = wanted - light_[i - 1], width = q.t - p.t;
    if (!(light > 0.0)) return p.t;
    const double root = std::sqrt(std::max(0.0, p.open * p.open + 2.0 * (q.open - p.open) * light / width));
    return std::clamp(p.t + 2.0 * light / (p.open + root), p.t, q.t);
}

std::vector<ShutterPoint> trapezoid_shutter(double open, double close) {
    return {{0.0, open > 0.0 ? 0.0 : 1.0}, {open, 1.0}, {close, 1.0}, {1.0, close < 1.0 ? 0.0 : 1.0}};
}

std::vector<ShutterPoint> read_shutter_curve(const std::string& file) {
    std::ifstream in(file);
    if (!in) throw Error(ErrorKind::kUsage, fmt::format("--shutter-curve: {} cannot be read", file));
    // A device may have no end.
    constexpr std::size_t kMost = 1 << 20;
    std::string all(kMost + 1, '\0');
    in.read(all.data(), static_cast<std::streamsize>(all.size()));
    all.resize(static_cast<std::size_t>(in.gcount()));
    if (all.size() > kMost) throw Error(ErrorKind::kUsage, fmt::format("--shutter-curve: {}: over 1 MB", file));
    std::vector<ShutterPoint> points;
    std::istringstream lines(all);
    std::string text;
    for (int number = 1; std::getline(lines, text); ++number) {
        std::string_view line(text);
        line = line.substr(0, line.find('#'));
        if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
        ShutterPoint point;
        if (!take_number(line, point.t) || !take_number(line, point.open) ||
            line.find_first_not_of(" \t\r") != std::string_view::npos) {
            throw Error(ErrorKind::kUsage,
                        fmt::format("--shutter-curve: {}, line {}: two numbers are wanted, T OPEN", file, number));
        }
        points.push_back(point);
        if (points.size() > 4096)
            throw Error(ErrorKind::kUsage, fmt::format("--shutter-curve: {}: over 4096 points", file));
    }
    if (points.size() < 2)
        throw Error(ErrorKind::kUsage, fmt::format("--shutter-curve: {}: two points or more are wanted", file));
    return points;
}

}  // namespace pentaprism
