#include "scene/keyframes.h"

#include <algorithm>
#include <cmath>

namespace pentaprism {

namespace {

/// Where a time lies among the keys: between `key` and the next one, at `fraction` of the way, which takes `span`
/// seconds.
struct Position {
    std::size_t key = 0;
    double fraction = 0.0, span = 0.0;
};

Position find_keys(const std::vector<float>& times, double time) {
    const auto after =
        std::upper_bound(times.begin(), times.end(), time, [](double t, float key) { return t < double(key); });
    if (after == times.begin()) return {};
    const auto key = static_cast<std::size_t>(after - times.begin()) - 1;
    if (after == times.end()) return {key, 0.0, 0.0};
    const double span = double(times[key + 1]) - double(times[key]);
    return {key, (time - double(times[key])) / span, span};
}

void normalise(std::span<double> q) {
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(length > 0.0)) {
        q[0] = q[1] = q[2] = 0.0;
        q[3] = 1.0;
        return;
    }
    for (double& value : q) value /= length;
}

/// Spherical linear interpolation along the shorter arc (glTF 2.0, C.4).
void slerp(const float* a, const float* b, double fraction, std::span<double> out) {
    double cosine = 0.0;
    for (std::size_t k = 0; k < 4; ++k) cosine += double(a[k]) * double(b[k]);
    const double sign = cosine < 0.0 ? -1.0 : 1.0;
    cosine = std::min(std::abs(cosine), 1.0);
    const double angle = std::acos(cosine), sine = std::sin(angle);
    // Nearly equal: the chord differs from the arc by less than the keys' own rounding.
    const bool chord = sine < 1e-6;
    const double from = chord ? 1.0 - fraction : std::sin((1.0 - fraction) * angle) / sine;
    const double to = sign * (chord ? fraction : std::sin(fraction * angle) / sine);
    for (std::size_t k = 0; k < 4; ++k) out[k] = from * double(a[k]) + to * double(b[k]);
}

/// Hermite spline through in-tangent, value, out-tangent of each key (glTF 2.0, C.5).
void cubic_spline(const Channel& channel, const Position& at, std::span<double> out) {
    const auto width = static_cast<std::size_t>(channel.width);
    const float* key = &channel.values[at.key * 3 * width];
    if (at.span <= 0.0) {
        for (std::size_t k = 0; k < width; ++k) out[k] = key[width + k];
        return;
    }
    const float* next = key + 3 * width;
    const double t = at.fraction, t2 = t * t, t3 = t2 * t;
    for (std::size_t k = 0; k < width; ++k) {
        const double value = key[width + k], leaving = at.span * key[2 * width + k];
        const double arriving = at.span * next[k], next_value = next[width + k];
        out[k] = (2 * t3 - 3 * t2 + 1) * value + (t3 - 2 * t2 + t) * leaving + (-2 * t3 + 3 * t2) * next_value +
                 (t3 - t2) * arriving;
    }
}

}  // namespace

void sample_channel(const Channel& channel, double time, std::span<double> out) {
    const Position at = find_keys(channel.times, time);
    const auto width = static_cast<std::size_t>(channel.width);
    if (channel.interpolation == Interpolation::kCubicSpline) {
        cubic_spline(channel, at, out);
    } else {
        const float* key = &channel.values[at.key * width];
        const bool between = channel.interpolation == Interpolation::kLinear && at.fraction > 0.0;
        if (between && channel.path == ChannelPath::kRotation) {
            slerp(key, key + width, at.fraction, out);
        } else {
            for (std::size_t k = 0; k < width; ++k) {
                const double value = key[k];
                out[k] = between ? value + (double(key[width + k]) - value) * at.fraction : value;
            }
        }
    }
    if (channel.path == ChannelPath::kRotation) normalise(out);
}

}  // namespace pentaprism
