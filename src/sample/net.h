#pragma once
// A (0, m, 5)-net in base 4: for N = 4^m points every elementary interval of volume 1/N, in any of the five dimensions
// together, holds exactly one point. Four dimensions are a (0, 4)-sequence over GF(4) (Niederreiter 1987; Faure's
// matrices of binomials), the fifth is the point's index over N (Niederreiter 1992, lemma 4.22).

#include <array>
#include <cstdint>

namespace pentaprism {

/// The first four coordinates of point `index` < 4096, 32 bits each, the first base-4 digit on top; 12 bits are used,
/// the rest are 0 (scrambling fills them). Dimensions: x, y, u, v. Within each pair the first 4 points also fall in the
/// four quadrants, the first 2 in different halves.
std::array<std::uint32_t, 4> net_point(std::uint32_t index);

/// Nested uniform (Owen) scrambling of a 32-bit coordinate by hashing (Laine & Karras 2011; constants of Burley 2020).
/// In base 2, hence also a nested scrambling in base 4.
std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed);

std::uint32_t reverse_bits(std::uint32_t x);

/// A well mixed hash of one word; chain calls for several.
std::uint32_t mix(std::uint32_t x);

}  // namespace pentaprism
