// The frame loop: tiles to rows, in this process or, as a shard, to bytes for another one.

#include <algorithm>
#include <chrono>
#include <mutex>
#include <pentaprism/error.h>
#include <pentaprism/render.h>
#include <pentaprism/shard.h>
#include <sys/resource.h>

#include "base/cpu.h"
#include "base/parallel.h"
#include "base/pool.h"
#include "gl/rasterizer.h"
#include "render/frame_tiles.h"
#include "render/picture_rows.h"
#include "render/shard_stream.h"
#include "scene/texture.h"

namespace pentaprism {
namespace {

using Clock = std::chrono::steady_clock;

double peak_megabytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;  // Linux counts kilobytes
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

void decide(FrameTiles& frame, std::span<const Tile> tiles, Pool<FrameTiles::Worker>& workers, ProgressMeter& meter) {
    parallel_for(tiles.size(), [&](std::size_t i) {
        frame.decide(tiles[i], *workers.lease());
        meter.step();
    });
}

// From this many samples a pixel on, those of a whole cell and what they see outgrow the cache: quarters of it are
// faster then, and slower below (docs/develop/performance.md, Samples).
constexpr int kSppOfSmallTiles = 256, kSmallTile = 16;

RenderSettings in_fast_tiles(RenderSettings settings) {
    if (settings.method.tile_size == kCellSize && settings.method.backend == Backend::kCpu &&
        !settings.image.target_error && settings.image.spp >= kSppOfSmallTiles)
        settings.method.tile_size = kSmallTile;
    return settings;
}

}  // namespace

Renderer::Renderer(const Scene& scene) : scene_(scene), textures_(make_textures(scene)) {}
Renderer::~Renderer() = default;

void Renderer::run(const RenderSettings& settings, double number, RenderStats& stats,
                   const std::function<void(FrameTiles&)>& body) {
    validate(settings);
    const auto start = Clock::now();
    set_thread_count(settings.method.threads);
    if (settings.image.environment != environment_name_) {
        environment_ = settings.image.environment.empty() ? nullptr : load_environment(settings.image.environment);
        environment_name_ = settings.image.environment;
    }
    FrameTiles frame(scene_, {textures_, environment_}, settings, number);
    body(frame);
    stats = {};
    frame.fill(stats);
    stats.times_ms["total"] = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    stats.peak_mb = peak_megabytes();
    stats.threads = thread_count();
    stats.isa = isa_name(cpu_isa());
    if (settings.method.backend == Backend::kGl) stats.device = gl_device_name();
}

void Renderer::render(const RenderSettings& settings, double number, RowSink& sink, RenderStats& stats,
                      const Progress& progress) {
    run(in_fast_tiles(settings), number, stats, [&](FrameTiles& frame) {
        PictureRows picture(frame.info(), frame.reach(), settings.image.exposure, sink);
        const std::vector<Tile>& tiles = frame.tiles();
        const std::vector<Tile> to_decide = frame.tiles_to_decide(tiles);
        ProgressMeter meter(progress, to_decide.size() + tiles.size());
        Pool<FrameTiles::Worker> workers;
        decide(frame, to_decide, workers, meter);
        picture.assemble(tiles, [&](std::size_t first, std::size_t last) {
            parallel_for(last - first, [&](std::size_t i) {
                const auto worker = workers.lease();
                frame.render(tiles[first + i], *worker);
                picture.add(worker->sums);
                meter.step();
            });
        });
    });
}

namespace {

constexpr std::size_t kRun = 256;

// Makes the tiles in parallel and writes them in order. `make` leaves one in the worker; `kept` is the member of it
// that holds it, and `write` its way to the output; `run` of them are kept until those before are written.
template <class T, class Make, class Write>
void write_tiles(FrameTiles& frame, const std::vector<Tile>& tiles, std::size_t run, const Progress& progress,
                 T FrameTiles::Worker::*kept, const Make& make, const Write& write) {
    const std::vector<Tile> to_decide = frame.tiles_to_decide(tiles);
    ProgressMeter meter(progress, to_decide.size() + tiles.size());
    Pool<FrameTiles::Worker> workers;
    decide(frame, to_decide, workers, meter);
    std::vector<T> done(std::min(run, tiles.size()));
    for (std::size_t first = 0; first < tiles.size(); first += run) {
        const std::size_t count = std::min(run, tiles.size() - first);
        parallel_for(count, [&](std::size_t i) {
            const auto worker = workers.lease();
            make(tiles[first + i], *worker);
            std::swap(done[i], (*worker).*kept);
            meter.step();
        });
        for (std::size_t i = 0; i < count; ++i) write(done[i]);
    }
}

RenderSettings in_cells(RenderSettings settings) {
    settings.method.tile_size = kCellSize;  // what those count in who read the tiles
    return settings;
}

}  // namespace

void Renderer::render_shard(const RenderSettings& settings, double number, const Shard& shard,
                            const FileMetadata& metadata, ByteSink& out, RenderStats& stats, const Progress& progress) {
    run(in_cells(settings), number, stats, [&](FrameTiles& frame) {
        TileOutput output(StreamKind::kShard, head_of(shard, frame.info(), frame.view(), settings, metadata), out);
        write_tiles(
            frame, tiles_of(frame.tiles(), shard), kRun, progress, &FrameTiles::Worker::sums,
            [&](const Tile& tile, FrameTiles::Worker& worker) { frame.render(tile, worker); },
            [&](const TileSums& sums) { write_sums(sums, output); });
        output.finish();
    });
}

void Renderer::render_samples(const RenderSettings& settings, double number, const FileMetadata& metadata,
                              ByteSink& out, RenderStats& stats, const Progress& progress) {
    run(in_cells(settings), number, stats, [&](FrameTiles& frame) {
        TileOutput output(StreamKind::kSamples, head_of({}, frame.info(), frame.view(), settings, metadata), out);
        write_tiles(
            frame, frame.tiles(), std::max<std::size_t>(1, kRun / static_cast<std::size_t>(settings.image.spp)),
            progress, &FrameTiles::Worker::samples,
            [&](const Tile& tile, FrameTiles::Worker& worker) { frame.store(tile, worker); },
            [&](const std::vector<StoredSample>& samples) { output.write(samples); });
        output.finish();
    });
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
