#pragma once
// Sample patterns that know nothing of vectors, to compare our own with (docs/develop/algorithms.md 9.1): each sample
// is a pure function of (pixel, index, seed).
//
// kSobol: Owen-scrambled Sobol' points (Joe & Kuo 2008; Burley 2020), each pixel scrambled by itself; below 16 samples
// a pixel, pairs of the first two dimensions, put together at random (Laine & Karras 2011). kBlueNoise: the five
// dimensions of one scrambled sequence for the whole period, dealt out to pixels along a Z curve whose digits are
// permuted at random (Ahmed & Wonka 2020), so that pixels that lie side by side have samples that go together, and
// errors that differ. kIndependent: random numbers.

#include <cstdint>
#include <pentaprism/settings.h>

namespace pentaprism {

/// 32-bit fractions of the unit square and the shutter.
struct PatternPoint {
    std::uint32_t x, y, u, v, t;
};

/// `sampler` is not kStratified. 0 <= index < spp; px, py below 2^11.
PatternPoint pattern_point(Sampler sampler, std::uint32_t px, std::uint32_t py, std::uint32_t index, std::uint32_t spp,
                           std::uint32_t seed);

/// Point `index` of Sobol' dimension 0 to 4.
std::uint32_t sobol(std::uint32_t index, int dimension);

}  // namespace pentaprism
