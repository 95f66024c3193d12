#include "resolve/filter.h"

#include <cmath>
#include <numbers>

namespace pentaprism {

double filter_radius(Filter filter) {
    switch (filter) {
        case Filter::kBox:
            return 0.5;
        case Filter::kTent:
            return 1.0;
        case Filter::kGaussian:
        case Filter::kBlackmanHarris:
            break;
    }
    return 1.5;
}

double filter_weight(Filter filter, double d) {
    d = std::abs(d);
    if (filter == Filter::kBox) return d <= 0.5 ? 1.0 : 0.0;
    if (d >= filter_radius(filter)) return 0.0;
    if (filter == Filter::kTent) return 1.0 - d;
    if (filter == Filter::kGaussian) return std::exp(-2.0 * d * d) - std::exp(-4.5);
    // Harris 1978: the four-term window of 92 dB.
    const double a = std::numbers::pi * (d / 1.5 + 1.0);
    return 0.35875 - 0.48829 * std::cos(a) + 0.14128 * std::cos(2.0 * a) - 0.01168 * std::cos(3.0 * a);
}

int filter_reach(Filter filter) {
    return filter == Filter::kBox ? 0 : 1;
}

}  // namespace pentaprism
