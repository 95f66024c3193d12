#pragma once
// Random numbers of the property tests: the same on every machine, and independent between seeds (a splitmix state that
// is a multiple of its own step would give one stream, shifted).

#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace pentaprism::support {

class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(mixed(mixed(seed + 0x632be59bd9b4e019ull))) {}

    std::uint64_t bits() { return mixed(state_ += 0x9e3779b97f4a7c15ull); }
    double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    double range(double low, double high) { return low + (high - low) * unit(); }
    double magnitude(double low, double high) { return low * std::pow(high / low, unit()); }
    int below(int n) { return static_cast<int>(bits() % static_cast<std::uint64_t>(n)); }
    int between(int low, int high) { return low + below(high - low + 1); }
    bool chance(double p) { return unit() < p; }
    double sign() { return (bits() & 1) != 0 ? 1.0 : -1.0; }

    /// In [0, 1], often at or next to an end.
    double biased() {
        switch (below(8)) {
            case 0:
                return 0.0;
            case 1:
                return 1.0;
            case 2:
                return unit() * 1e-4;
            case 3:
                return 1.0 - unit() * 1e-4;
            default:
                return unit();
        }
    }

  private:
    static std::uint64_t mixed(std::uint64_t x) {
        x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
        x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
        return x ^ (x >> 31);
    }
    std::uint64_t state_;
};

/// PENTAPRISM_LONG=k does k times the work.
inline int effort() {
    const char* factor = std::getenv("PENTAPRISM_LONG");
    const int k = factor != nullptr ? std::atoi(factor) : 1;
    return k > 1 ? k : 1;
}

}  // namespace pentaprism::support
