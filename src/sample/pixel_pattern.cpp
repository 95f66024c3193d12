#include "sample/pixel_pattern.h"

#include <array>
#include <bit>

#include "sample/net.h"

namespace pentaprism {
namespace {

constexpr int kDimensions = 5;
using Directions = std::array<std::array<std::uint32_t, 32>, kDimensions>;

// Joe and Kuo's first dimensions: degree s, coefficients a, initial m.
constexpr Directions make_directions() {
    constexpr int kDegree[kDimensions] = {0, 1, 2, 3, 3};
    constexpr std::uint32_t kA[kDimensions] = {0, 0, 1, 1, 2},
                            kM[kDimensions][3] = {{}, {1}, {1, 3}, {1, 3, 1}, {1, 1, 1}};
    Directions v{};
    for (int b = 0; b < 32; ++b) v[0][b] = 1u << (31 - b);
    for (int d = 1; d < kDimensions; ++d) {
        const int s = kDegree[d];
        for (int b = 0; b < 32; ++b) {
            if (b < s) {
                v[d][b] = kM[d][b] << (31 - b);
                continue;
            }
            v[d][b] = v[d][b - s] ^ (v[d][b - s] >> s);
            for (int k = 1; k < s; ++k)
                if (kA[d] >> (s - 1 - k) & 1u) v[d][b] ^= v[d][b - k];
        }
    }
    return v;
}
constexpr Directions kDirections = make_directions();
static_assert(kDirections[4][3] >> 24 == 0xb0 && kDirections[4][5] >> 24 == 0xdc, "algorithms.md 9.1");

std::uint32_t seed_of(std::uint32_t base, std::uint32_t dimension) {
    return mix(base + (dimension + 1u) * 0x9e3779b9u);
}

std::uint32_t shuffled(std::uint32_t index, std::uint32_t n, std::uint32_t seed) {
    // Owen scrambling of the index with its lowest bit on top.
    return reverse_bits(owen_scramble(reverse_bits(index), seed)) & (std::bit_ceil(n) - 1u);
}

PatternPoint of_pixel(std::uint32_t pixel, std::uint32_t index, std::uint32_t spp) {
    const auto scrambled = [&](std::uint32_t i, int from, std::uint32_t dimension) {
        return owen_scramble(sobol(i, from), seed_of(pixel, dimension));
    };
    if (spp >= 16)
        return {scrambled(index, 0, 0), scrambled(index, 1, 1), scrambled(index, 2, 2), scrambled(index, 3, 3),
                scrambled(index, 4, 4)};
    const std::uint32_t lens = shuffled(index, spp, seed_of(pixel, 5)), time = shuffled(index, spp, seed_of(pixel, 6));
    return {scrambled(index, 0, 0), scrambled(index, 1, 1), scrambled(lens, 0, 2), scrambled(lens, 1, 3),
            scrambled(time, 0, 4)};
}

std::uint32_t spread_bits(std::uint32_t x) {
    x = (x | x << 8) & 0x00ff00ffu;
    x = (x | x << 4) & 0x0f0f0f0fu;
    x = (x | x << 2) & 0x33333333u;
    return (x | x << 1) & 0x55555555u;
}

// One of the permutations of a base-4 digit: the first choice, then among those left.
std::uint32_t permuted_digit(std::uint32_t digit, std::uint32_t random) {
    std::array<std::uint32_t, 4> order = {0, 1, 2, 3};
    for (std::uint32_t n = 4; n > 1; --n) {
        std::swap(order[n - 1], order[random % n]);
        random /= n;
    }
    return order[digit];
}

// Permutes each base-4 digit of the number by a choice that depends on the digits above it.
std::uint32_t permuted_digits(std::uint32_t number, int digits, std::uint32_t seed) {
    std::uint32_t result = 0;
    for (int i = digits - 1; i >= 0; --i) {
        const std::uint32_t above = i < 15 ? number >> (2 * i + 2) : 0u;
        const std::uint32_t random = mix(mix(above + seed) + static_cast<std::uint32_t>(i)) >> 8;
        result |= permuted_digit(number >> (2 * i) & 3u, random) << (2 * i);
    }
    return result;
}

PatternPoint along_z_curve(std::uint32_t px, std::uint32_t py, std::uint32_t index, std::uint32_t spp,
                           std::uint32_t seed) {
    constexpr int kPeriodDigits = 11;
    const int bits = std::bit_width(spp - 1u);
    // Pixels and samples are digits of one number; each pixel has 2^bits consecutive points of the sequence.
    const std::uint32_t place = permuted_digits(spread_bits(px) | spread_bits(py) << 1, kPeriodDigits, mix(seed + 7u));
    const std::uint32_t i = (place << bits | shuffled(index, std::bit_ceil(spp), mix(mix(seed + 8u) + place)));
    PatternPoint p{};
    std::uint32_t* const to[kDimensions] = {&p.x, &p.y, &p.u, &p.v, &p.t};
    for (int d = 0; d < kDimensions; ++d) *to[d] = owen_scramble(sobol(i, d), seed_of(mix(seed), d));
    return p;
}

}  // namespace

std::uint32_t sobol(std::uint32_t index, int dimension) {
    std::uint32_t x = 0;
    for (int b = 0; index != 0; ++b, index >>= 1)
        if (index & 1u) x ^= kDirections[dimension][b];
    return x;
}

PatternPoint pattern_point(Sampler sampler, std::uint32_t px, std::uint32_t py, std::uint32_t index, std::uint32_t spp,
                           std::uint32_t seed) {
    const std::uint32_t pixel = mix(mix(px * 0x9e3779b9u + mix(py + 1u)) + seed);
    if (sampler == Sampler::kSobol) return of_pixel(pixel, index, spp);
    if (sampler == Sampler::kBlueNoise) return along_z_curve(px, py, index, spp, seed);
    const std::uint32_t sample = mix(pixel + 0x85ebca6bu * (index + 1u));
    return {seed_of(sample, 0), seed_of(sample, 1), seed_of(sample, 2), seed_of(sample, 3), seed_of(sample, 4)};
}

}  // namespace pentaprism
