#include "sample/cats_eye.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace pentaprism {
namespace {

constexpr int kMoves = 64, kPlaces = 512;
constexpr double kLargestMove = 1.5;

// A disk moved by m along s leaves, at distance p across, the chord from m - h(p) to h(p) with h(p) = sqrt(1 - p^2):
// its length is 2 h(p) - m, up to |p| = sqrt(1 - m^2 / 4). The area from 0 to p is p h(p) + asin(p) - m p.
double area(double p, double move) {
    return p * std::sqrt(std::max(0.0, 1.0 - p * p)) + std::asin(p) - move * p;
}

// Where the share of the whole disk's area before p is reached by what is left: areas grow alike across, chords are
// scaled along, so density is the same everywhere.
double moved_across(double p, double move) {
    const double end = std::sqrt(1.0 - 0.25 * move * move);
    const double wanted = area(p, 0.0) / area(1.0, 0.0) * area(end, move);
    double low = 0.0, high = end;
    for (int i = 0; i < 50; ++i) {
        const double middle = 0.5 * (low + high);
        (area(middle, move) < wanted ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

}  // namespace

CatsEye::CatsEye(double amount, int width, int height, double ratio)
    : amount_(std::min(amount, kLargestMove)), width_(width), height_(height), ratio_(ratio) {
    if (!on()) return;
    across_.resize(std::size_t{kMoves + 1} * (kPlaces + 1));
    for (int m = 0; m <= kMoves; ++m)
        for (int i = 0; i <= kPlaces; ++i) {
            const double root = static_cast<double>(i) / kPlaces;
            across_[std::size_t{kPlaces + 1} * m + i] = moved_across(1.0 - root * root, kLargestMove * m / kMoves);
        }
}

CatsEye::Outline CatsEye::outline(double x, double y) const {
    const glm::dvec2 place(x - 0.5 * width_, 0.5 * height_ - y);
    Outline outline;
    outline.ratio_ = ratio_;
    const double distance = glm::length(place);
    if (distance > 0.0) outline.direction_ = place / distance;
    outline.move_ = std::min(amount_ * distance / (0.5 * std::hypot(width_, height_)), kLargestMove);
    const double column = outline.move_ / kLargestMove * kMoves;
    const int first = std::min(static_cast<int>(column), kMoves - 1);
    outline.between_ = column - first;
    outline.across0_ = &across_[std::size_t{kPlaces + 1} * first];
    outline.across1_ = outline.across0_ + kPlaces + 1;
    return outline;
}

glm::vec2 CatsEye::Outline::at(const glm::vec2& uv) const {
    const glm::dvec2 disk(uv.x, uv.y / ratio_), normal(-direction_.y, direction_.x);
    const double s = glm::dot(disk, direction_), p = std::clamp(glm::dot(disk, normal), -1.0, 1.0);
    const double at = std::sqrt(1.0 - std::abs(p)) * kPlaces;
    const int i = std::min(static_cast<int>(at), kPlaces - 1);
    const auto look_up = [&](const double* column) { return column[i] + (at - i) * (column[i + 1] - column[i]); };
    const double end = std::sqrt(1.0 - 0.25 * move_ * move_);
    const double across =
        std::copysign(std::min(look_up(across0_) + between_ * (look_up(across1_) - look_up(across0_)), end), p);
    const double chord = std::sqrt(1.0 - p * p), left = std::max(0.0, std::sqrt(1.0 - across * across) - 0.5 * move_);
    const double along = 0.5 * move_ + (chord > 0.0 ? std::clamp(s / chord, -1.0, 1.0) * left : 0.0);
    const glm::dvec2 to = along * direction_ + across * normal;
    return {std::clamp(static_cast<float>(to.x), -1.0f, 1.0f),
            static_cast<float>(std::clamp(to.y, -1.0, 1.0) * ratio_)};
}

}  // namespace pentaprism
