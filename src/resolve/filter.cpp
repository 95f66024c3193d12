#include "resolve/filter.h"

#include <algorithm>
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
    if (std::abs(d) > filter_radius(filter)) return 0.0;
    switch (filter) {
        case Filter::kBox:
            return 1.0;
        case Filter::kTent:
            return 1.0 - std::abs(d);
        case Filter::kGaussian:
            return std::max(0.0, std::exp(-2.0 * d * d) - std::exp(-4.5));
        case Filter::kBlackmanHarris:
            break;
    }
    // Harris 1978: the four-term window of 92 dB.
    const double a = std::numbers::pi * (d / 1.5 + 1.0);
    return 0.35875 - 0.48829 * std::cos(a) + 0.14128 * std::cos(2.0 * a) - 0.01168 * std::cos(3.0 * a);
}

int filter_reach(Filter filter) {
    return filter == Filter::kBox ? 0 : 1;
}

}  // namespace pentaprism
