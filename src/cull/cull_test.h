#pragma once
// What a culling test is: a cheap, conservative question asked before the exact test. One file src/cull/NAME.cpp each,
// which ends with `extern const CullTest NAME_test{...}`; the build collects them into cull_table(), and the
// property tests, the statistics and `--culling NAME` (with '-' for '_') take them from there.
// docs/develop/adding-a-culling-test.md goes through it step by step.

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <type_traits>

#include "bound/local_triangle.h"
#include "cull/occluders.h"

namespace pentaprism {

/// Closed ranges of what is asked about: (hx, hy) in pixels from the cell's middle, y up, within [-16, 16]; and the
/// lens and shutter ranges in which the samples lie. |u| <= 1, |v| <= Lens::ratio, 0 <= t <= 1; whatever the aperture,
/// a sample's (u, v / ratio) is on the unit disk, but for an ulp.
struct Footprint {
    float x0, x1, y0, y1;
    Domain domain;
};

/// What the samples of a footprint have in common. Tile: 8x8 pixels, the whole lens and shutter. Pixel: one of them.
/// Bucket: one vector of the sample table, 4x4 pixels and the samples' own ranges of screen, lens and shutter.
enum class Grain : std::uint8_t { kTile, kPixel, kBucket };
inline constexpr int kCullTileSize = 8;  ///< pixels a side of a tile of culling tests

/// Room for numbers that one function of a test leaves for the next; each test has its own struct for them.
template <std::size_t kBytes>
struct alignas(16) CullMemory {
    std::array<std::byte, kBytes> bytes;

    template <class T>
    T& as() {
        static_assert(sizeof(T) <= kBytes && alignof(T) <= 16 && std::is_trivially_copyable_v<T>);
        return *reinterpret_cast<T*>(bytes.data());
    }
    template <class T>
    const T& as() const {
        return const_cast<CullMemory*>(this)->as<T>();
    }
};

/// Of a triangle.
struct CullSetup : CullMemory<4608> {
    const Occluders* occluders = nullptr;  ///< what the cell shows so far, if anybody keeps account of it
};

/// Of a triangle and a footprint.
struct CullState : CullMemory<640> {
    const CullSetup* setup = nullptr;  ///< what begin() left; only for tests that have one
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

    Grain grain = Grain::kPixel;  ///< asked at this footprint if the user does not say at which

    /// Optional: what is worked out once for a triangle, before its footprints. `picture` is the whole picture in the
    /// cell's coordinates, which may reach beyond [-16, 16], with the whole lens and shutter. False promises that no
    /// sample of the cell hits the triangle.
    bool (*begin)(const LocalTriangle& triangle, const Footprint& picture, CullSetup& setup) = nullptr;

    /// False: as a paper prints it, with the flaws that lose samples. Kept to be measured; changes the picture.
    bool conservative = true;

    /// Refuses what CullSetup::occluders hide, too, which is no sample's own doing: whoever walks triangles keeps them
    /// up to date, front to back. The promises above are about coverage; this one is that the picture does not change.
    bool asks_occluders = false;
};

/// `prepare` of a test that asks nothing of footprints beyond the triangle's screen bounds.
inline bool keeps_every_footprint(const LocalTriangle&, const Footprint&, CullState&) {
    return true;
}
/// `keeps` of a test that bounds the screen alone and says nothing of single samples.
inline bool keeps_every_sample(const CullState&, const LocalSample&) {
    return true;
}

/// All culling tests, by name.
std::span<const CullTest* const> cull_table();

/// The test of that name, or nullptr.
const CullTest* find_cull_test(std::string_view name);

}  // namespace pentaprism
