#pragma once
// What a culling test is: a cheap, conservative question asked before the exact test. One file src/cull/NAME.cpp each,
// which ends with `extern const CullTest NAME_test{...}`; the build collects them into cull_table(), and the
// property tests, the statistics and `--culling NAME` (with '-' for '_') take them from there.

#include <array>
#include <span>
#include <string_view>

#include "bound/local_triangle.h"

namespace pentaprism {

/// Closed ranges of what is asked about: (hx, hy) in pixels from the cell's middle, y up, within [-16, 16]; and the
/// lens and shutter ranges in which the samples lie. |u| <= 1, |v| <= Lens::ratio, 0 <= t <= 1.
struct Footprint {
    float x0, x1, y0, y1;
    Domain domain;
};

/// What prepare() works out for one triangle and footprint and keeps() reads; each test has its own meaning for the
/// numbers.
struct CullState {
    std::array<float, 64> values;
};

struct CullTest {
    const char* name;   ///< `--culling` value and row in reports: the file's stem with '-' for '_'
    const char* paper;  ///< where the bound comes from

    /// False promises: no sample in the footprint hits the triangle, as cover_sample() decides, rounding included.
    /// Never throws or allocates; thread-safe. Triangles at or behind the camera plane, of zero area and with NaN are
    /// allowed.
    bool (*prepare)(const LocalTriangle& triangle, const Footprint& footprint, CullState& state);

    /// False promises the same of one sample of the footprint. Asked only after prepare() returned true.
    bool (*keeps)(const CullState& state, const LocalSample& sample);
};

/// All culling tests, by name.
std::span<const CullTest* const> cull_table();

/// The test of that name, or nullptr.
const CullTest* find_cull_test(std::string_view name);

}  // namespace pentaprism
