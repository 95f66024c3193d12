#include "sample/net.h"

#include <vector>

namespace pentaprism {
namespace {

constexpr int kDigits = 6;
constexpr std::uint32_t kPoints = 1u << 2 * kDigits;

// GF(4) = {0, 1, w, w + 1} as 0, 1, 2, 3: addition is xor.
constexpr std::uint8_t kProduct[4][4] = {{0, 0, 0, 0}, {0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}};

// Digit r of the dimension with parameter alpha: the sum over c >= r of binomial(c, r) * alpha^(c - r) * (digit c of
// the index). Binomials count modulo 2, the field's characteristic.
std::uint8_t digit(std::uint32_t index, int r, std::uint8_t alpha) {
    std::uint8_t sum = 0, power = 1;
    for (int c = r; c < kDigits; ++c) {
        const bool odd = (c & r) == r;  // Lucas: binomial(c, r) is odd
        if (odd) sum ^= kProduct[power][(index >> (2 * c)) & 3];
        power = kProduct[power][alpha];
    }
    return sum;
}

// One relabelling of digits for each dimension: linear bijections of GF(2)^2 chosen so that the top bits of a pair (x,
// y) or (u, v) of the first four points are 00, 11, 01, 10.
constexpr std::uint8_t kSwapped[4] = {0, 2, 1, 3};  // (high, low) -> (low, high)
constexpr std::uint8_t kSummed[4] = {0, 2, 3, 1};   // (high, low) -> (high + low, high)

using Point = std::array<std::uint32_t, 4>;

Point make_point(std::uint32_t index) {
    constexpr std::uint8_t kAlpha[4] = {2, 3, 0, 1};  // x, y, u, v
    Point point{};
    for (int dimension = 0; dimension < 4; ++dimension) {
        const std::uint8_t* relabel = dimension % 2 == 0 ? kSwapped : kSummed;
        for (int r = 0; r < kDigits; ++r)
            point[dimension] |= static_cast<std::uint32_t>(relabel[digit(index, r, kAlpha[dimension])]) << (30 - 2 * r);
    }
    return point;
}

}  // namespace

Point net_point(std::uint32_t index) {
    static const std::vector<Point> points = [] {
        std::vector<Point> all(kPoints);
        for (std::uint32_t i = 0; i < kPoints; ++i) all[i] = make_point(i);
        return all;
    }();
    return points[index % kPoints];
}

std::uint32_t reverse_bits(std::uint32_t x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
    x = reverse_bits(x);
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return reverse_bits(x);
}

std::uint32_t mix(std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

}  // namespace pentaprism
