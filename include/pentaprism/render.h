#pragma once
// From a scene to pixels. A frame is delivered in bands of rows, top to bottom, so a picture never has to fit in
// memory.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <pentaprism/scene.h>
#include <pentaprism/settings.h>
#include <pentaprism/stats.h>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace pentaprism {

/// What is known of a frame before its first pixel: it goes into the header of an EXR file.
struct FrameInfo {
    int width = 0, height = 0;           ///< of the whole picture
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< the part that is rendered, half open
    double frame = 0.0, fps = 24.0;
    double shutter_open = 0.0, shutter_close = 0.0;  ///< seconds; of a rolling shutter: of the first row, of the last
    double readout = 0.0;          ///< seconds between the first row's opening and the last's; 0: no rolling shutter
    double lens_radius = 0.0;      ///< metres, 0: pinhole
    double focus_distance = 0.0;   ///< metres; 0 for a pinhole
    double fstop = 0.0;            ///< 0 for a pinhole
    double focal_length_mm = 0.0;  ///< 0 of an orthographic camera
    std::array<double, 16> world_to_camera{};  ///< column-major, at mid-shutter; camera looks along -z
    std::array<double, 16> world_to_ndc{};     ///< column-major, at mid-shutter; NDC in [-1,1], y up
    double fx = 0.0, fy = 0.0;                 ///< pixels: focal length (perspective) or pixels a metre (orthographic)
    std::string camera;
    int max_motion_segments = 1;
    /// The camera at the shutter knots k / max_motion_segments: seconds, and the rest as above. Zoom and focus pulls
    /// are in it.
    struct Knot {
        double time = 0.0;
        std::array<double, 16> world_to_camera{};
        double fx = 0.0, fy = 0.0, lens_radius = 0.0, focus_distance = 0.0;
    };
    std::vector<Knot> knots;
    std::vector<Aov> aovs;                                        ///< what PixelRows::aovs holds, in this order
    std::vector<std::pair<std::string, std::string>> attributes;  ///< for the header of a file: names of ids
};

/// Rows y0 .. y0 + count - 1 of the picture, x from FrameInfo::x0 to x1. `rgba` holds 4 floats a pixel: linear colour
/// with exposure applied, premultiplied by alpha where the background is absent; alpha is coverage. `z` holds one float
/// a pixel: the depth along the optical axis (metres) of the closest sample, +infinity where nothing is hit.
/// `aovs` holds the channels of FrameInfo::aovs one after the other (pentaprism/aov.h), each a float or an unsigned
/// 32-bit number for each pixel of the rows.
struct PixelRows {
    int y0 = 0, count = 0, width = 0;
    std::span<const float> rgba, z;
    std::span<const float> aovs{};
};

/// Receives a frame. begin() is called once, then rows() for bands from top to bottom that together are the picture.
class RowSink {
  public:
    virtual ~RowSink() = default;
    virtual void begin(const FrameInfo& info) = 0;
    virtual void rows(const PixelRows& band) = 0;
};

/// Called now and then from one thread at a time with the part of the frame that is done, 0 to 1. Returning false stops
/// the frame: render_frame throws Error(kRender) "interrupted".
using Progress = std::function<bool(double done)>;

class ByteSink;
class Environment;
class FrameTiles;
class Textures;
struct FileMetadata;
struct Shard;

/// Renders frames of one scene and keeps between them what does not change, such as filtered textures.
class Renderer {
  public:
    /// The scene must outlive the renderer and not change.
    explicit Renderer(const Scene& scene);
    ~Renderer();

    /// As render_frame(). One frame at a time: a frame uses all threads by itself.
    void render(const RenderSettings& settings, double frame, RowSink& sink, RenderStats& stats,
                const Progress& progress = {});

    /// Part of a frame, as bytes that ShardMerger (pentaprism/shard.h) makes the picture of. `metadata` is for the
    /// file that the picture will be written to. The statistics are those of the part.
    void render_shard(const RenderSettings& settings, double frame, const Shard& shard, const FileMetadata& metadata,
                      ByteSink& out, RenderStats& stats, const Progress& progress = {});

    /// A frame's samples, as bytes that StoredSamples (pentaprism/stored_samples.h) makes pictures of: 32 for each.
    void render_samples(const RenderSettings& settings, double frame, const FileMetadata& metadata, ByteSink& out,
                        RenderStats& stats, const Progress& progress = {});

  private:
    void run(const RenderSettings& settings, double frame, RenderStats& stats,
             const std::function<void(FrameTiles&)>& body);

    const Scene& scene_;
    std::shared_ptr<const Textures> textures_;
    std::shared_ptr<const Environment> environment_;
    std::string environment_name_;
};

/// Renders frame number `frame` into `sink`. Throws Error. The same input gives the same pixels, bit for bit, for any
/// number of threads, tile size and CPU target.
void render_frame(const Scene& scene, const RenderSettings& settings, double frame, RowSink& sink, RenderStats& stats,
                  const Progress& progress = {});

/// A whole picture in memory, row by row from the top.
struct Picture {
    int width = 0, height = 0;
    std::vector<float> rgba;  ///< 4 * width * height
    std::vector<float> z;     ///< width * height
    std::vector<float> aovs;  ///< width * height for each channel of FrameInfo::aovs, one channel after the other
    FrameInfo info;
};
Picture render_picture(const Scene& scene, const RenderSettings& settings, double frame, RenderStats& stats);

/// One name for `--culling`: a test, where it comes from, and the footprint it is asked at unless the user says
/// another: "tile" (8x8 pixels), "pixel", or "bucket" (a stratum of the samples of 4x4 pixels).
struct CullingChoice {
    std::string name, description, footprint;
    bool conservative = true;  ///< false: as a paper prints it; loses samples, kept to be measured
};
/// "auto" first, then each culling test. MethodSettings::culling is "auto" or a combination of the others,
/// `TEST[@FOOTPRINT]` joined by `+`.
std::vector<CullingChoice> culling_tests();

/// Throws Error(kUsage) if MethodSettings::culling could not be that.
void check_culling(const std::string& culling);

/// The CPU target in use: avx512, avx2, neon or scalar (the environment's PENTAPRISM_ISA, else the best there is).
/// Throws Error(kUsage) if the environment names a target that this processor or build does not have.
std::string cpu_target();

}  // namespace pentaprism
