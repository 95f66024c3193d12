#pragma once
// The laboratory: every way to find what each sample sees, on the same frames, counted and timed side by side.
//
// Sample test efficiency (STE), the measure of the field, is defined in Fatahalian et al. 2009, Data-Parallel
// Rasterization of Micropolygons with Defocus and Motion Blur: samples covered / samples tested.

#include <cstdint>
#include <functional>
#include <pentaprism/render.h>
#include <string>
#include <vector>

namespace pentaprism {

/// How much of the scene's own blur a measurement has: factors on the shutter's length and on the lens radius.
struct BenchEffect {
    std::string name;
    double motion = 0.0, defocus = 0.0;
};

/// still, motion, motion-x2, defocus, defocus-x2, both, both-x2. Where a name is asked for, other factors up to 64 will
/// do, too: both-x0.5, motion-x8.
std::vector<BenchEffect> bench_effects();

/// What can be measured: "auto", each of culling_tests() by itself, and the other ways to find what is visible:
/// accumulation, interleaved, micropolygon and, if this build has it, raytrace.
std::vector<std::string> bench_methods();

/// What is measured unless said otherwise: all of them but micropolygon, which takes far longer than all others.
std::vector<std::string> bench_default_methods();

/// What to measure. A scene without a lens of its own gets f/2.8, one without a shutter half a frame.
struct BenchPlan {
    std::vector<std::string> scenes;   ///< as load_scene() takes them; empty: bench_default_scenes()
    std::vector<std::string> effects;  ///< names of bench_effects(), or other factors; empty: all seven
    std::vector<std::string>
        methods;              ///< of bench_methods(), and combinations of culling tests; empty: the default ones
    RenderSettings settings;  ///< image, method.seed, .threads, .backend, animation; lens and shutter: see effects
    double frame = -1.0;      ///< below 0: 24 of a built-in scene, 0 of a file
    int runs = 5;             ///< timed runs of each method, methods in turn; the median counts
    double seconds = 4.0;     ///< a slower method gets fewer runs: as many as fit in these seconds, at least one
    std::int64_t most_tests = 32'000'000;  ///< where the triangles' boxes hold more samples, a part of the picture's
                                           ///< tiles is measured, the same with all methods; 0: no limit
    std::vector<int> peer_threads;  ///< Embree is timed with each of these numbers of threads (0: all); empty: not
    bool images = true;             ///< pictures and heat maps, for bench_html()
    int picture_width = 512, picture_spp = 32;  ///< of the frames that are shown
    int map_width = 400, map_spp = 4;           ///< heat maps are made of smaller pictures, whole
};
BenchPlan full_bench_plan();   ///< 1024x768, 16 samples per pixel
BenchPlan quick_bench_plan();  ///< small pictures of two scenes

/// Built-in scenes that the literature measured, as far as there are.
std::vector<std::string> bench_default_scenes();

/// One method on one frame. Times are wall times in milliseconds with all threads of the plan.
struct BenchRow {
    std::string scene, effect, method, backend = "cpu";  ///< or gl-geometry, gl-compute
    bool conservative = true;                            ///< the method promises to lose no sample
    bool own_arithmetic = false;  ///< decides by other arithmetic than the exact test: differs at edges and depth ties
    bool own_samples = false;     ///< sees by other samples than the rest, so that the picture is another one
    std::int64_t samples = 0;     ///< of the tiles that were measured (BenchCell::share)
    std::int64_t tested = 0;      ///< exact 5D tests
    std::int64_t covered = 0;     ///< of them accepted
    std::int64_t footprints =
        0;  ///< questions for all samples of a footprint: CullTest::prepare, which sets up the next
    std::int64_t kept_footprints = 0;  ///< of them answered by "may be hit"
    std::int64_t asked = 0;            ///< questions for single samples
    std::int64_t false_culls = 0;  ///< samples whose triangle or depth differs, in any bit, from those of `none` on the
                                   ///< same samples; with `own_arithmetic` whose triangle does
    double setup_ms = 0.0;         ///< bounds, bins and all questions of the culling test, the exact tests left out; of
                                   ///< `auto`, whose questions depend on depths, bounds and bins alone
    double test_ms = 0.0;          ///< the rest: exact tests, depth, opacity
    double frame_ms = 0.0;         ///< visibility of the whole frame, from posed triangles to the hit of every sample
    int runs = 0;                  ///< timed runs behind the medians
    double peak_mb = 0.0;  ///< largest resident memory while it ran, what the laboratory itself keeps not counted

    double ste() const { return tested > 0 ? static_cast<double>(covered) / static_cast<double>(tested) : 0.0; }
    double tests_per_covered() const {
        return covered > 0 ? static_cast<double>(tested) / static_cast<double>(covered) : 0.0;
    }
};

/// Embree on the same samples: visibility alone.
struct BenchPeer {
    std::string scene, effect, peer;
    int threads = 0, runs = 0;
    double build_ms = 0.0, trace_ms = 0.0, ours_ms = 0.0;
    double ratio() const { return ours_ms > 0.0 ? (build_ms + trace_ms) / ours_ms : 0.0; }
};

struct BenchMachine {
    std::string cpu, isa, compiler, system;
    int processors = 0, threads = 0;
    double memory_gb = 0.0;
};

/// A scene as it was measured.
struct BenchScene {
    std::string name, description;
    std::int64_t triangles = 0;
    double frame = 0.0, fps = 24.0;
    double shutter_frames = 0.0;  ///< of effect `motion`
    double lens_radius = 0.0;     ///< metres, of effect `defocus`
    double fstop = 0.0, focus_distance = 0.0;
    bool own_lens = true;  ///< false: the default was used
};

/// What a frame looks like to a sample, in the mean over the samples that hit something.
struct BenchCell {
    std::string scene, effect;
    double share = 1.0;      ///< part of the picture's tiles that was measured
    double motion_px = 0.0;  ///< way of the surface over the open shutter, pixels
    double blur_px = 0.0;    ///< radius of its circle of confusion, pixels
    double hit = 0.0;        ///< part of the samples that hit something
};

enum class BenchImageKind : std::uint8_t {
    kPicture,  ///< the frame as rendered; `method` is empty
    kTested,   ///< heat map: exact tests a sample
    kWasted,   ///< heat map: of them those that missed
    kMissing,  ///< samples that the method lost
};

/// A PNG file in memory.
struct BenchImage {
    std::string scene, effect, method;
    BenchImageKind kind = BenchImageKind::kPicture;
    int width = 0, height = 0;
    double largest = 0.0;  ///< heat maps: the value of the hottest colour, tests a sample
    double mean = 0.0;     ///< heat maps: the mean over the picture, tests a sample; kMissing: the part that is lost
    std::vector<std::uint8_t> png;
};

struct BenchReport {
    BenchMachine machine;
    int width = 0, height = 0, spp = 0;
    std::uint32_t seed = 0;
    std::vector<BenchScene> scenes;
    std::vector<BenchCell> cells;
    std::vector<BenchRow> rows;
    std::vector<BenchPeer> peers;
    std::vector<BenchImage> images;
    double seconds = 0.0;  ///< that the whole took
};

/// Called before each step and now and then within it. Returning false stops: run_bench throws Error(kRender)
/// "interrupted".
struct BenchStep {
    std::string what;   ///< such as "hand motion-x2, none: counting"
    double done = 0.0;  ///< of the whole plan, 0 to 1
};
using BenchProgress = std::function<bool(const BenchStep& step)>;

/// Throws Error: kUsage for a name that does not exist, kScene, kBackend when a peer is asked for that this build does
/// not have.
BenchReport run_bench(const BenchPlan& plan, const BenchProgress& progress = {});

/// A number that a paper printed.
struct PublishedFigure {
    std::string paper, scene, effect, method;  ///< the paper's own words
    std::string our_scene, our_method;         ///< what of ours comes nearest; scene without "builtin:"
    double ste = 0.0;                          ///< a fraction; 0: not given
    double milliseconds = 0.0;                 ///< a frame; 0: not given
};
std::vector<PublishedFigure> published_figures();

/// In what their scene and ours differ; empty for a scene that the papers do not have.
std::string published_difference(const std::string& our_scene);

// The report in each format. All of them end with a newline.

std::string bench_json(const BenchReport& report);   ///< machine, rows, peers, scenes, cells
std::string bench_csv(const BenchReport& report);    ///< one line for each row, with a heading
std::string bench_latex(const BenchReport& report);  ///< rows of a tabular, one table for each scene
std::string bench_table(const BenchReport& report);  ///< for a terminal
std::string bench_html(const BenchReport& report);   ///< one page that needs nothing else

}  // namespace pentaprism
