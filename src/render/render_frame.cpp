// The frame loop: the only code that knows the order of the stages.
//
//   scene -> view, frame -> bins -> [ tile: cover -> shade -> film ] -> rows

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>
#include <pentaprism/error.h>
#include <pentaprism/render.h>
#include <sys/resource.h>

#include "base/cpu.h"
#include "base/parallel.h"
#include "base/pool.h"
#include "render/visibility.h"
#include "resolve/aov_film.h"
#include "resolve/film.h"
#include "scene/texture.h"
#include "shade/shade_tile.h"

namespace pentaprism {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::duration duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
}

double peak_megabytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;  // Linux counts kilobytes
}

PixelRect crop_of(const ImageSettings& image) {
    if (!image.crop) return {0, image.width, 0, image.height};
    return {(*image.crop)[0], (*image.crop)[1], (*image.crop)[2], (*image.crop)[3]};
}

PixelRect grown(const PixelRect& rect, int reach, int width, int height) {
    return {std::max(0, rect.x0 - reach), std::min(width, rect.x1 + reach), std::max(0, rect.y0 - reach),
            std::min(height, rect.y1 + reach)};
}

// glm matrices are column-major, as FrameInfo's.
void store(const glm::dmat4& matrix, std::array<double, 16>& out) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) out[4 * column + row] = matrix[column][row];
}

FrameInfo frame_info(const Frame& frame, std::span<const Index> animations, const RenderSettings& settings,
                     double number, const PixelRect& crop) {
    const View& view = frame.view;
    FrameInfo info;
    info.width = view.width;
    info.height = view.height;
    info.x0 = crop.x0, info.x1 = crop.x1, info.y0 = crop.y0, info.y1 = crop.y1;
    info.frame = number;
    info.fps = settings.animation.fps;
    info.shutter_open = view.shutter.open;
    info.shutter_close = view.shutter.close;
    info.readout = view.shutter.readout();
    info.lens_radius = view.lens.radius;
    info.focus_distance = view.lens.focus_distance;
    info.fstop = view.lens.fstop;
    info.focal_length_mm = view.focal_length_mm;
    info.camera = view.camera_name;
    for (const Part& part : frame.parts) info.max_motion_segments = std::max(info.max_motion_segments, part.segments);
    const glm::dmat4 to_camera = world_to_camera(view, frame.middle);
    glm::dmat4 projection(0.0);
    projection[0][0] = view.fx * 2.0 / view.width;
    projection[1][1] = view.fy * 2.0 / view.height;
    projection[2][2] = -1.0;
    projection[2][3] = view.perspective ? -1.0 : 0.0;
    projection[3][3] = view.perspective ? 0.0 : 1.0;
    info.fx = view.fx;
    info.fy = view.fy;
    store(to_camera, info.world_to_camera);
    store(projection * to_camera, info.world_to_ndc);
    for (int k = 0; k <= info.max_motion_segments; ++k) {
        FrameInfo::Knot knot;
        knot.time = view.shutter.at(static_cast<double>(k) / info.max_motion_segments);
        store(world_to_camera(view, evaluate(*frame.scene, animations, knot.time)), knot.world_to_camera);
        info.knots.push_back(knot);
        if (view.shutter.close == view.shutter.open) break;  // one instant
    }
    return info;
}

glm::vec3 background_of(const Scene& scene, const ImageSettings& image) {
    if (image.background) return {(*image.background)[0], (*image.background)[1], (*image.background)[2]};
    return scene.background.value_or(glm::vec3(0.0f));
}

ShadingRate rate_of(const std::string& name) {
    return name == "sample" ? ShadingRate::kSample : name == "pixel" ? ShadingRate::kPixel : ShadingRate::kDecoupled;
}

// Tallest band of rows whose film stays small whatever the width; a usual picture is a single band.
int band_rows(const PixelRect& rect) {
    constexpr int kFilmPixels = 1 << 23;
    const int rows = std::max(1, kFilmPixels / std::max(1, rect.x1 - rect.x0) / kCellSize) * kCellSize;
    return std::min(rows, (rect.y1 - rect.y0 + 2 * kCellSize - 1) / kCellSize * kCellSize + kCellSize);
}

// Tells the caller how much is done, from one thread at a time, and stops the frame when it says so.
class ProgressMeter {
  public:
    ProgressMeter(const Progress& progress, std::size_t total) : progress_(progress), total_(total) {}
    void step() {
        const std::size_t done = ++done_;
        if (!progress_) return;
        const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
        if (lock && !progress_(static_cast<double>(done) / static_cast<double>(total_)))
            throw Error(ErrorKind::kRender, "interrupted");
    }

  private:
    const Progress& progress_;
    std::size_t total_;
    std::atomic<std::size_t> done_{0};
    std::mutex mutex_;
};

// What one thread needs to take a tile from its bin to the film, and what that cost.
struct TileWorker {
    Hits hits;
    TileShader shader;
    TileShade shade;
    AovFilm::Worker aovs;
};

struct TileCosts {
    std::atomic<std::int64_t> cover_ns{0}, shade_ns{0}, resolve_ns{0}, tested{0}, covered{0}, shaded{0};
};

std::int64_t nanoseconds(Clock::duration duration) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
}

void render_tile(const Visibility& visibility, const ShadingScene& shading, const SampleTable& samples,
                 const Tile& tile, TileWorker& worker, Film& film, TileCosts& costs) {
    const auto start = Clock::now();
    CoverCounts counts;
    visibility.cover(tile, worker.hits, counts);
    const auto covered = Clock::now();
    costs.shaded += worker.shader.shade(shading, samples, tile, worker.hits, worker.shade);
    const auto shaded = Clock::now();
    film.add(tile, samples, worker.hits, worker.shade);
    const auto resolved = Clock::now();
    costs.cover_ns += nanoseconds(covered - start);
    costs.shade_ns += nanoseconds(shaded - covered);
    costs.resolve_ns += nanoseconds(resolved - shaded);
    costs.tested += counts.tested;
    costs.covered += counts.covered;
}

void deliver(Film& film, AovFilm* aovs, int rendered_to, bool last, RowSink& sink) {
    PixelRows rows = film.take_rows(rendered_to, last);
    if (rows.count == 0) return;
    if (aovs) rows.aovs = aovs->rows(rows.y0, rows.count);
    sink.rows(rows);
}

// What output variables look up beside the frame itself; made only for those that need it.
struct AovTables {
    std::optional<FrameIds> ids;
    std::optional<Flow> flow;

    AovTables(const Frame& frame, const RenderSettings& settings, double number) {
        const auto asks = [&](std::initializer_list<Aov> some) {
            return std::any_of(some.begin(), some.end(), [&](Aov aov) {
                return std::find(settings.image.aovs.begin(), settings.image.aovs.end(), aov) !=
                       settings.image.aovs.end();
            });
        };
        if (asks({Aov::kObjectId, Aov::kMaterialId, Aov::kCryptomatte, Aov::kTime})) ids.emplace(frame);
        if (asks({Aov::kMotion})) flow.emplace(*frame.scene, settings, number);
    }

    // Names of what the numbers in a picture stand for.
    void describe(std::span<const Aov> aovs, FrameInfo& info) const {
        info.aovs.assign(aovs.begin(), aovs.end());
        for (const Aov aov : aovs) {
            if (aov == Aov::kObjectId) info.attributes.emplace_back("objects", ids->objects.json());
            if (aov == Aov::kMaterialId) info.attributes.emplace_back("materials", ids->materials.json());
            if (aov != Aov::kCryptomatte) continue;
            for (const auto& attribute : ids->objects.cryptomatte_attributes("CryptoObject"))
                info.attributes.push_back(attribute);
            for (const auto& attribute : ids->materials.cryptomatte_attributes("CryptoMaterial"))
                info.attributes.push_back(attribute);
        }
    }
};

}  // namespace

Renderer::Renderer(const Scene& scene) : scene_(scene), textures_(make_textures(scene)) {}
Renderer::~Renderer() = default;

void Renderer::render(const RenderSettings& settings, double number, RowSink& sink, RenderStats& stats,
                      const Progress& progress) {
    validate(settings);
    const auto start = Clock::now();
    set_thread_count(settings.method.threads);
    stats = {};
    stats.isa = isa_name(cpu_isa());
    stats.threads = thread_count();
    if (settings.method.backend == Backend::kGl) stats.device = gl_device_name();

    if (settings.image.environment != environment_name_) {
        environment_ = settings.image.environment.empty() ? nullptr : load_environment(settings.image.environment);
        environment_name_ = settings.image.environment;
    }
    const View view = make_view(scene_, settings, number);
    const std::vector<Index> animations = choose_animations(scene_, settings.animation.animation);
    Frame frame = pose_frame(scene_, view, animations, settings.shutter);
    frame.textures = textures_;
    const auto posed = Clock::now();
    const SampleTable samples = make_samples(frame, settings.image.spp, settings.method);
    const auto sampled = Clock::now();

    const PixelRect crop = crop_of(settings.image);
    FilmSettings film_settings{crop.x0,
                               crop.y0,
                               crop.x1,
                               crop.y1,
                               0,
                               settings.image.spp,
                               settings.image.filter,
                               background_of(scene_, settings.image),
                               settings.image.exposure};
    film_settings.band_rows = band_rows(crop);
    Film film(film_settings);
    const PixelRect rendered = grown(crop, film.reach(), view.width, view.height);
    const Visibility visibility(frame, samples, settings.method, rendered);
    const auto binned = Clock::now();
    const ShadingScene shading(frame, {settings.method.shadows, settings.method.brdf, settings.method.texture_filter,
                                       rate_of(settings.method.shading), settings.image.spp, environment_});
    const auto prepared = Clock::now();

    FrameInfo info = frame_info(frame, animations, settings, number, crop);
    const AovTables aov_tables(frame, settings, number);
    aov_tables.describe(settings.image.aovs, info);
    std::optional<AovFilm> aov_film;
    if (!settings.image.aovs.empty())
        aov_film.emplace(settings.image.aovs,
                         AovSources{&shading, aov_tables.ids ? &*aov_tables.ids : nullptr,
                                    aov_tables.flow ? &*aov_tables.flow : nullptr, film_settings.background,
                                    static_cast<float>(std::exp2(settings.image.exposure))},
                         crop.x0, crop.x1, film_settings.band_rows + 2 * film.reach() + 1);

    sink.begin(info);
    const std::vector<Tile>& tiles = visibility.tiles();
    ProgressMeter meter(progress, tiles.size());
    Pool<TileWorker> workers;
    TileCosts costs;
    for (std::size_t first = 0; first < tiles.size();) {
        const int band_end = tiles[first].y0 + film_settings.band_rows;
        std::size_t last = first;
        while (last < tiles.size() && tiles[last].y1 <= band_end) ++last;
        parallel_for(last - first, [&](std::size_t i) {
            const auto worker = workers.lease();
            const Tile& tile = tiles[first + i];
            render_tile(visibility, shading, samples, tile, *worker, film, costs);
            if (aov_film) aov_film->add(tile, samples, worker->hits, worker->shade, crop.y0, crop.y1, worker->aovs);
            meter.step();
        });
        deliver(film, aov_film ? &*aov_film : nullptr, tiles[last - 1].y1, last == tiles.size(), sink);
        first = last;
    }
    const auto done = Clock::now();

    const double per_thread = 1e-6 / stats.threads;
    const double cover_ms = static_cast<double>(costs.cover_ns) * per_thread;
    stats.times_ms = {{"pose", milliseconds(posed - start)},
                      {"samples", milliseconds(sampled - posed)},
                      {"bin", milliseconds(binned - sampled)},
                      {"prepare_shading", milliseconds(prepared - binned)},
                      {"cover", cover_ms},
                      {"visibility", milliseconds(binned - sampled) + cover_ms},
                      {"shade", static_cast<double>(costs.shade_ns) * per_thread},
                      {"resolve", static_cast<double>(costs.resolve_ns) * per_thread},
                      {"total", milliseconds(done - start)}};
    stats.triangles = frame.triangle_count();
    stats.moving_triangles = 0;
    for (const Part& part : frame.parts)
        stats.moving_triangles += std::int64_t{part.triangle_count} * (part.moves ? part.segments : 1);
    stats.samples = std::int64_t{crop.x1 - crop.x0} * (crop.y1 - crop.y0) * settings.image.spp;
    stats.tested = costs.tested;
    stats.covered = costs.covered;
    stats.shaded = costs.shaded;
    stats.peak_mb = peak_megabytes();
}

void render_frame(const Scene& scene, const RenderSettings& settings, double frame, RowSink& sink, RenderStats& stats,
                  const Progress& progress) {
    Renderer(scene).render(settings, frame, sink, stats, progress);
}

Picture render_picture(const Scene& scene, const RenderSettings& settings, double frame, RenderStats& stats) {
    struct Collector : RowSink {
        Picture picture;
        void begin(const FrameInfo& info) override {
            picture.info = info;
            picture.width = info.x1 - info.x0;
            picture.height = info.y1 - info.y0;
        }
        void rows(const PixelRows& band) override {
            picture.rgba.insert(picture.rgba.end(), band.rgba.begin(), band.rgba.end());
            picture.z.insert(picture.z.end(), band.z.begin(), band.z.end());
            // Channels lie one after the other in a band and in the picture.
            const std::size_t pixels = band.z.size(), all = std::size_t(picture.width) * picture.height;
            const std::size_t channels = band.aovs.size() / pixels, first = picture.z.size() - pixels;
            picture.aovs.resize(channels * all);
            for (std::size_t c = 0; c < channels; ++c)
                std::copy_n(band.aovs.begin() + c * pixels, pixels, picture.aovs.begin() + c * all + first);
        }
    } collector;
    render_frame(scene, settings, frame, collector, stats);
    return std::move(collector.picture);
}

std::vector<CullingChoice> culling_tests() {
    std::vector<CullingChoice> choices{
        {"auto", "vectors of samples, strata bounds, depth hierarchy: the fast path", "bucket"}};
    for (const CullTest* test : cull_table())
        choices.push_back({test->name, test->paper, name_of(test->grain), test->conservative});
    return choices;
}

void check_culling(const std::string& culling) {
    if (culling != "auto") parse_culling(culling);
}

std::string cpu_target() {
    return isa_name(cpu_isa());
}

}  // namespace pentaprism
