#pragma once
// Triangles of masked and blended materials that need no test at any sample, found once for a scene: most of a trunk
// whose bark is called a mask, and the middle of a leaf.

#include <cstdint>
#include <pentaprism/scene.h>
#include <vector>

namespace pentaprism {

class Pyramid;

enum class OpacityClass : std::uint8_t { kMixed, kSolid, kClear };

/// Smallest and largest opacity in rectangles of texels of one image: each level halves the one before.
class OpacityRange {
  public:
    explicit OpacityRange(const Pyramid& pyramid);

    /// Bounds over all bilinear look-ups with uv in [u0, u1] x [v0, v1], in units of 1/255; may be wider than the
    /// truth.
    struct Bounds {
        int least, most;
    };
    Bounds over(const TextureRef& ref, float u0, float u1, float v0, float v1) const;

  private:
    struct Level {
        int width, height;
        std::vector<std::uint8_t> least, most;
    };
    std::vector<Level> levels_;
};

/// For each triangle of the primitive, or empty if its material is opaque. `range` is that of the material's base
/// colour texture, or null where it has none. Promises: at every point of a solid triangle is_opaque_at()
/// (frame/opacity.h) would say true, of a clear one false.
std::vector<OpacityClass> classify_opacity(const Scene& scene, const OpacityRange* range, const Primitive& primitive);

}  // namespace pentaprism
