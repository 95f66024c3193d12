#pragma once
// Everything that decides how a frame looks, apart from the scene. Defaults are those of the command line.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pentaprism {

enum class Filter : std::uint8_t { kBox, kTent, kGaussian, kBlackmanHarris };
enum class ToneMap : std::uint8_t { kNone, kAces, kFilmic };
/// Outputs beside colour, alpha and depth; pentaprism/aov.h tells what each means.
enum class Aov : std::uint8_t {
    kDepth,
    kNormal,
    kPosition,
    kUv,
    kMotion,
    kCoc,
    kTime,
    kObjectId,
    kMaterialId,
    kCryptomatte,
    kCoverage,
    kVariance,
    kAlbedo,
    kOcclusion,
    kSte,  ///< MethodSettings::culling must name a test: the fast path keeps no account of pixels
    kSamples
};
/// kGltf: Lambert under GGX, energy-conserving. kBurley: Burley's diffuse lobe (2012) and no compensation, which is
/// what Blender's renderer had until 4.0; for comparisons with it.
enum class BrdfModel : std::uint8_t { kGltf, kBurley };
/// What of a texture a shading point stands for: a point; its pixel; its pixel, motion and lens.
enum class TextureFilter : std::uint8_t { kOff, kPixel, kFull };
/// How surfaces that stop a part of the light are shown. kStochastic: by a part of the samples. kABuffer: by each
/// sample, one over the other; for VisibilityMethod::kStochastic on the processor. Maps of shadows are stochastic in
/// both.
enum class Transparency : std::uint8_t { kStochastic, kABuffer };
enum class ShadowMode : std::uint8_t { kOff, kStill, kMoving };
enum class ShutterPosition : std::uint8_t { kStart, kCenter, kEnd };
/// The edge of the picture that is exposed first; kNone: all of it at once.
enum class RollingShutter : std::uint8_t { kNone, kTop, kBottom, kLeft, kRight };

/// How much light the shutter lets in at a part of its open time; straight between points.
struct ShutterPoint {
    double t = 0.0;     ///< 0 opens, 1 closes
    double open = 0.0;  ///< 0 or more, in any unit: the picture is no darker for a slow shutter
};

struct ImageSettings {
    int width = 1280, height = 720;  ///< pixels, 1 to 16384
    int spp = 16;                    ///< samples per pixel, 1 to 4096
    /// Set: each block of 4 x 4 pixels gets spp to max_spp samples per pixel: 64 where these bring the error (standard
    /// deviation) of its pixels down to this, as far as a few samples that are not shown can tell, more or fewer by its
    /// noise. Of the root of linear colour, exposure applied: 0.01 is a hundredth of what lies between black and white.
    /// Above 0 to 1. For kStochastic on the processor, whose tiles are of 32 pixels then; samples cannot be stored.
    std::optional<double> target_error;
    int max_spp = 1024;  ///< spp to 4096
    Filter filter = Filter::kBlackmanHarris;
    std::optional<std::array<int, 4>> crop;  ///< X0, X1, Y0, Y1 in pixels, half open: equals that part of the whole
    double exposure = 0.0;                   ///< EV: colours are multiplied by 2^exposure
    ToneMap tonemap = ToneMap::kAces;        ///< PNG only
    std::optional<std::array<float, 3>> background;  ///< linear; unset: the scene's, else black
    std::vector<Aov> aovs;                           ///< outputs beside the colour, each at most once
    double flow_step = 1.0;   ///< frames from this one to the earlier and the later moment that kMotion and kOcclusion
                              ///< lead to, 0 to 1e6; their numbers are pixels for that step
    std::string environment;  ///< instead: "sky", or a .hdr or .exr picture (latitude-longitude, up is up) that lights
                              ///< the scene, too
};

/// A camera a little elsewhere than the scene has it: shifted along its own axes (right, up, backwards; metres), then
/// turned about them (up and down, left and right, roll; degrees, in the order y, x, z).
struct CameraOffset {
    std::array<double, 3> shift_m{}, turn_deg{};
    bool operator==(const CameraOffset&) const = default;
};

/// An unset value comes from the scene's camera (LensInfo), else from the default in the comment.
struct CameraSettings {
    std::string camera;                     ///< name or index; empty: the first, else one that frames the scene
    std::optional<double> focal_length_mm;  ///< changes the field of view: tan(fovx / 2) = sensor / (2 focal length)
    std::optional<double> sensor_width_mm;  ///< 36
    bool defocus = true;                    ///< false: a pinhole whatever else is said
    std::optional<double> fstop;            ///< unset: a pinhole
    std::optional<double> lens_radius;      ///< metres; instead of fstop
    std::optional<double> focus_distance;   ///< metres along the axis; unset: the middle of what is seen
    std::string focus_object;               ///< node whose bounding box centre at mid-shutter is in focus
    std::optional<std::array<double, 2>> focus_pixel;  ///< pixel whose nearest surface at mid-shutter is in focus
    std::optional<int> aperture_blades;                ///< 0: a disk, else 3 or more
    std::optional<double> aperture_rotation_deg;       ///< 0
    std::optional<double> aperture_roundness;          ///< 0: straight blades, to 1: a disk
    std::optional<double> aperture_ratio;              ///< 1; height of the circle of confusion over its width
    /// Depths in metres, nearest and farthest, between which all is sharp; blur begins beyond them, smoothly, over a
    /// quarter of their difference. Holds the focus distance, which if unset is where both ends would blur alike.
    std::optional<std::array<double, 2>> focus_range;
    std::optional<double> max_foreground_blur;  ///< pixels: largest radius of blur in front of the focus
    /// The plane of focus leans: degrees about the picture's horizontal axis (above 0: its top is farther) and about
    /// the vertical one (above 0: its right side is farther). 0
    std::optional<double> tilt_deg, swing_deg;
    std::string aperture_image;      ///< .png or .exr file whose luminance is the lens, instead of blades
    std::optional<double> cats_eye;  ///< how far a corner's lens is cut by the barrel, in lens radii; 0 to 1.5, 0
    CameraOffset offset;             ///< the same for the whole frame
    CameraOffset offset_before, offset_after;  ///< of the neighbouring frames: what flow leads to
};

struct ShutterSettings {
    bool motion_blur = true;                              ///< false: everything stands still at mid-shutter
    std::optional<double> shutter;                        ///< open time in frames; 0.5
    ShutterPosition position = ShutterPosition::kCenter;  ///< where the frame's time lies in the open time
    std::vector<ShutterPoint> curve;  ///< empty: open all the time. Else 2 or more, t ascending; closed outside of them
    RollingShutter rolling = RollingShutter::kNone;
    std::optional<double> rolling_duration;  ///< frames between the first and the last row's opening; 0.5
    int motion_segments = 0;  ///< straight pieces of each path; 0: as many as keep the error below 0.1 pixel
};

struct AnimationSettings {
    double fps = 24.0;              ///< frame N is at N / fps seconds
    std::string animation = "all";  ///< name or index of one clip, or "all"
};

/// How the visible surface of each sample is found. Shading and film are the same for all.
enum class VisibilityMethod {
    kStochastic,    ///< stochastic rasterization: every sample has its own (x, y, u, v, t)
    kAccumulation,  ///< spp passes, each with one (u, v, t) for the whole picture (Haeberli & Akeley 1990): ghosts
    kInterleaved,   ///< InterleaveUVT (Fatahalian et al. 2009): 64 or more (u, v, t) that blocks of pixels share
    kRaytrace,      ///< the samples of kStochastic, traced with Embree; Error(kBackend) in a build without it
    kMicropolygon   ///< the samples of kStochastic, triangles diced to about a pixel (Reyes; Cook et al. 1987)
};

/// How the samples of a pixel lie in pixel, lens and shutter (docs/learn/sample-patterns.md).
enum class Sampler : std::uint8_t {
    kStratified,  ///< nets over pixels and blocks of 4 x 4, vectors close in lens and time: the fastest
    kSobol,       ///< Sobol' points, scrambled anew in each pixel
    kBlueNoise,   ///< one Sobol' sequence for the picture, in an order that makes neighbours' errors differ
    kIndependent  ///< random, for comparison
};

/// What finds the visible surface of each sample, and shades where MethodSettings::shading is pixel.
enum class Backend {
    kCpu,
    kGl  ///< OpenGL 4.5, with the samples and the exact test of kCpu; Error(kBackend) without a driver or in a build
         ///< without it. Of the visibility methods those that rasterize whole triangles
};

/// How kGl finds what is seen. Hits and counts are the same.
enum class GlPipeline {
    kAuto,      ///< kCompute, unless the scene is too large for the device's storage blocks
    kGeometry,  ///< the papers' pipeline: a geometry shader emits bounds, a framebuffer keeps the nearest
    kCompute    ///< compute shaders sort triangles into tiles
};

struct MethodSettings {
    VisibilityMethod visibility = VisibilityMethod::kStochastic;
    Backend backend = Backend::kCpu;
    GlPipeline gl_pipeline = GlPipeline::kAuto;
    /// "auto" or a combination of culling_tests(); kRaytrace and kMicropolygon have no use for one: "auto" alone.
    std::string culling = "auto";
    std::string shading = "decoupled";  ///< how often visible surfaces are shaded
    TextureFilter texture_filter = TextureFilter::kFull;
    BrdfModel brdf = BrdfModel::kGltf;
    Transparency transparency = Transparency::kStochastic;
    ShadowMode shadows = ShadowMode::kMoving;  ///< kStill: of everything as it is at mid-shutter
    Sampler sampler = Sampler::kStratified;
    std::uint32_t seed = 0;  ///< of the sample pattern
    int threads = 0;         ///< 0: all processors
    int tile_size = 32;      ///< pixels, 8, 16 or 32 (then 16 from 256 spp on): never changes the picture
};

struct RenderSettings {
    ImageSettings image;
    CameraSettings camera;
    ShutterSettings shutter;
    AnimationSettings animation;
    MethodSettings method;
};

/// Throws Error(kUsage) for the first setting whose value has no meaning, by the name of its option: one that is not
/// finite, out of its range, or at odds with another. What only the scene can tell (a camera's name) is not looked at.
void validate(const RenderSettings& settings);

/// Opens evenly from t = 0 to `open`, closes evenly from `close` to 1; 0 <= open <= close <= 1.
std::vector<ShutterPoint> trapezoid_shutter(double open, double close);

/// A text file with a line "T OPEN" for each point; blank lines and what follows a # are skipped. Throws Error(kUsage).
std::vector<ShutterPoint> read_shutter_curve(const std::string& file);

}  // namespace pentaprism
