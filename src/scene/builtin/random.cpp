#include "scene/builtin/random.h"

#include <glm/common.hpp>

namespace pentaprism::builtin {
namespace {

double lattice(std::int64_t x, std::int64_t y) {
    std::uint64_t h =
        static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15u ^ static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fu;
    h = (h ^ (h >> 31u)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27u)) * 0x94d049bb133111ebu;
    return static_cast<double>(h >> 40u) * (1.0 / 16777216.0);
}

}  // namespace

double noise(glm::dvec2 p) {
    const glm::dvec2 cell = glm::floor(p);
    const glm::dvec2 f = p - cell;
    const glm::dvec2 s = f * f * (3.0 - 2.0 * f);
    const auto x = static_cast<std::int64_t>(cell.x), y = static_cast<std::int64_t>(cell.y);
    return glm::mix(glm::mix(lattice(x, y), lattice(x + 1, y), s.x),
                    glm::mix(lattice(x, y + 1), lattice(x + 1, y + 1), s.x), s.y);
}

double fractal_noise(glm::dvec2 p, int octaves) {
    double sum = 0.0, weight = 0.0, strength = 1.0;
    for (int i = 0; i < octaves; ++i) {
        sum += strength * noise(p + 17.3 * i);
        weight += strength;
        strength *= 0.5;
        p *= 2.0;
    }
    return sum / weight;
}

}  // namespace pentaprism::builtin
