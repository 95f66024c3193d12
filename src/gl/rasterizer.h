#pragma once
// Visibility and shading on a graphics card: the same frame, the same samples and the same exact test as the coverage
// stage, in OpenGL (gl/gl_rasterizer.h). A build may be without it.

#include <memory>
#include <pentaprism/settings.h>
#include <string>
#include <vector>

#include "bound/screen_bounds.h"
#include "cover/cover.h"
#include "shade/shading_scene.h"
#include "shade/tile_shade.h"

namespace pentaprism {

class Rasterizer {
  public:
    virtual ~Rasterizer() = default;

    /// As cover_with_test(): hits, counts and map of a tile. `hits` has been reset. Thread-safe; the pixels around are
    /// rendered with the first tile that asks, while others wait.
    virtual void cover(const Tile& tile, Hits& hits, CoverCounts& counts, CoverMap* map) const = 0;

    /// From now on shades what is seen, as ShadingRate::kPixel. Before the first cover(); `scene` must outlive this.
    /// Throws Error(kBackend) if the scene is too large for the device.
    virtual void shade_with(const ShadingScene& scene) = 0;

    /// As TileShader::shade(), of a tile that was covered, once; what misses show is left to others. Thread-safe.
    virtual std::int64_t shade(const Tile& tile, const Hits& hits, TileShade& out) const = 0;

    /// GlPipeline that does it: geometry or compute.
    virtual const char* pipeline() const = 0;
};

/// Of `method` culling and gl_pipeline count. `limits`: the pixels that will be asked for. Frame and table must outlive
/// it. Throws Error(kBackend) in a build without OpenGL, without a driver and when it fails, Error(kUsage) for culling
/// that is not there in GLSL.
std::unique_ptr<Rasterizer> make_gl_rasterizer(const Frame& frame, const SampleTable& table,
                                               const MethodSettings& method, const PixelRect& limits);

/// What `--culling` takes with this backend, without combinations; empty in a build without it.
std::vector<std::string> gl_culling_choices();

/// Renderer and version of the driver; throws as make_gl_rasterizer().
std::string gl_device_name();

}  // namespace pentaprism
