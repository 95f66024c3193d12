#pragma once
// Randomness for procedural scenes. The same seed gives the same scene with every compiler and library: the generator
// is PCG32 (O'Neill 2014, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms for Random Number
// Generation"), and no std:: distribution is used, since their results are not specified.
//
// Take numbers in separate statements or inside braces: the order of evaluation of function arguments is unspecified.

#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace pentaprism::builtin {

class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed * 2 + 1) { next(), next(); }

    std::uint32_t next() {
        const std::uint64_t old = state_;
        state_ = old * 6364136223846793005u + 1442695040888963407u;
        const auto shifted = static_cast<std::uint32_t>(((old >> 18u) ^ old) >> 27u);
        const auto turn = static_cast<std::uint32_t>(old >> 59u);
        return (shifted >> turn) | (shifted << ((32u - turn) & 31u));
    }

    double uniform() { return next() * (1.0 / 4294967296.0); }  ///< [0, 1)
    double range(double low, double high) { return low + (high - low) * uniform(); }
    double around(double centre, double spread) { return range(centre - spread, centre + spread); }
    double angle() { return range(0.0, 6.283185307179586); }
    bool chance(double probability) { return uniform() < probability; }
    int below(int n) { return static_cast<int>(uniform() * n); }

    /// Uniform on the unit sphere.
    glm::dvec3 direction() {
        const double z = range(-1.0, 1.0);
        const double a = angle();
        const double r = std::sqrt(1.0 - z * z);
        return {r * std::cos(a), z, r * std::sin(a)};
    }

    /// Uniform in the unit disk.
    glm::dvec2 in_disk() {
        const double r = std::sqrt(uniform());
        const double a = angle();
        return {r * std::cos(a), r * std::sin(a)};
    }

  private:
    std::uint64_t state_;
};

/// Smooth value noise in [0, 1], features about one unit wide; fractal_noise adds `octaves` of it, each half as wide
/// and strong.
double noise(glm::dvec2 p);
double fractal_noise(glm::dvec2 p, int octaves);

}  // namespace pentaprism::builtin
