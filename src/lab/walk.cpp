// The time of a culling test is split by a second kind of walk: over the same triangles, pixels and samples, with each
// question asked, but every sample refused in the end, so that no exact test follows.

#include "lab/walk.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <mutex>
#include <pentaprism/error.h>
#include <utility>

#include "base/parallel.h"

namespace pentaprism {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

bool prepare_nothing(const LocalTriangle&, const Footprint&, CullState&) {
    return true;
}
bool refuse(const CullState&, const LocalSample&) {
    return false;
}
constexpr CullTest kRefuse{"refuse", "", prepare_nothing, refuse};

// The culling with a last step that refuses every sample: asked when all others have kept it, at the finest of their
// footprints, so that it adds no other.
Culling refusing(Culling culling) {
    Grain finest = Grain::kTile;
    for (const CullStep& step : culling) finest = std::max(finest, step.grain);
    culling.push_back({&kRefuse, finest});
    return culling;
}

constexpr std::pair<const char*, VisibilityMethod> kVisibilities[] = {
    {"accumulation", VisibilityMethod::kAccumulation},
    {"interleaved", VisibilityMethod::kInterleaved},
    {"micropolygon", VisibilityMethod::kMicropolygon},
    {"raytrace", VisibilityMethod::kRaytrace},
};

// Sums up the counts of tiles from all threads.
class Adder {
  public:
    explicit Adder(CoverCounts& sum) : sum_(sum) {}
    void add(const CoverCounts& counts) {
        const std::lock_guard<std::mutex> lock(mutex_);
        sum_.add(counts);
    }

  private:
    CoverCounts& sum_;
    std::mutex mutex_;
};

PixelRect whole(const Frame& frame) {
    return {0, frame.view.width, 0, frame.view.height};
}

// Tests of a tile with the bounding box alone.
std::int64_t box_tests(const Bins& bins, const Tile& tile, int spp) {
    std::int64_t pixels = 0;
    for (const std::uint32_t entry : bins.tile(tile.x0, tile.y0)) {
        const BinnedTriangle& box = bins.triangles()[entry];
        pixels += std::int64_t{std::min<int>(box.x1, tile.x1) - std::max<int>(box.x0, tile.x0)} *
                  (std::min<int>(box.y1, tile.y1) - std::max<int>(box.y0, tile.y0));
    }
    return pixels * spp;
}

// A place in [0, 1) for each tile, so that those below any bound lie evenly over the picture: the R2 sequence's lattice
// (Roberts 2018, The Unreasonable Effectiveness of Quasirandom Sequences).
double place_of(const Tile& tile, int size) {
    const double place = 0.7548776662466927 * (tile.x0 / size) + 0.5698402909980532 * (tile.y0 / size);
    return place - std::floor(place);
}

// body(px, py, entry in Hits) for the samples of a tile.
template <class Body>
void for_each_sample(const Tile& tile, const Hits& hits, int slots, const Body& body) {
    for (int py = tile.y0; py < tile.y1; ++py)
        for (int px = tile.x0; px < tile.x1; ++px)
            for (int slot = 0; slot < slots; ++slot) body(px, py, hits.entry(px, py, slot));
}

bool differ(const Hits& a, const Hits& b, std::size_t s, bool depths) {
    return a.triangle[s] != b.triangle[s] || (depths && std::memcmp(&a.depth[s], &b.depth[s], sizeof(float)) != 0);
}

// The middle of a triangle at one knot, in pixels, with its circle of confusion there.
struct Seen {
    double x = 0, y = 0, radius = 0;
};
Seen middle_at(const Frame& frame, std::uint32_t triangle, int knot) {
    const Part& part = frame.parts[frame.part_of[triangle]];
    const std::size_t moved = part.moves ? static_cast<std::size_t>(knot) * part.vertex_count : 0;
    Seen seen;
    for (int corner = 0; corner < 3; ++corner) {
        const glm::vec4& p = frame.points[frame.corners[3 * std::size_t{triangle} + corner] + moved];
        const double w = std::max(1e-3f, p.z);
        seen.x += p.x / w / 3;
        seen.y += p.y / w / 3;
        seen.radius += std::abs(p.w) / w / 3;
    }
    return seen;
}

}  // namespace

MethodSettings settings_of(const std::string& method, MethodSettings settings) {
    for (const auto& [name, visibility] : kVisibilities)
        if (method == name) {
            settings.visibility = visibility;
            settings.culling = "auto";
            return settings;
        }
    check_culling(method);
    settings.visibility = VisibilityMethod::kStochastic;
    settings.culling = method;
    return settings;
}

bool has_own_arithmetic(const std::string& method) {
    const VisibilityMethod visibility = settings_of(method, {}).visibility;
    return visibility == VisibilityMethod::kMicropolygon || visibility == VisibilityMethod::kRaytrace;
}

FrameWalk::FrameWalk(const Frame& frame, const SampleTable& samples, const MethodSettings& settings,
                     std::int64_t most_tests, KeepGoing keep_going)
    : frame_(frame), samples_(samples), settings_(settings), keep_going_(std::move(keep_going)) {
    choose_tiles(most_tests);
}

void FrameWalk::choose_tiles(std::int64_t most_tests) {
    tiles_ = processors_own("none").tiles();
    if (most_tests <= 0) return;
    const Bins bins(frame_, settings_.tile_size, whole(frame_));
    std::int64_t tests = 0;
    for (const Tile& tile : tiles_) tests += box_tests(bins, tile, samples_.spp());
    if (tests <= most_tests) return;
    const auto all = static_cast<double>(tiles_.size());
    const double wanted = std::max(static_cast<double>(most_tests) / static_cast<double>(tests), 1.0 / all);
    std::vector<double> places;
    for (const Tile& tile : tiles_) places.push_back(place_of(tile, settings_.tile_size));
    std::vector<double> sorted = places;
    std::sort(sorted.begin(), sorted.end());
    const double bound = sorted[static_cast<std::size_t>(wanted * all) - 1];
    std::vector<Tile> chosen;
    for (std::size_t i = 0; i < tiles_.size(); ++i)
        if (places[i] <= bound) chosen.push_back(tiles_[i]);
    tiles_ = std::move(chosen);
    share_ = static_cast<double>(tiles_.size()) / all;
}

Visibility FrameWalk::visibility_of(const std::string& method) const {
    return Visibility(frame_, samples_, settings_of(method, settings_), whole(frame_));
}

Visibility FrameWalk::processors_own(const std::string& method) const {
    MethodSettings settings = settings_of(method, settings_);
    settings.backend = Backend::kCpu;
    return Visibility(frame_, samples_, settings, whole(frame_));
}

double FrameWalk::for_each_tile(const std::string& what, const TileWorkBody& body) {
    const auto start = Clock::now();
    std::atomic<bool> stopped{false};
    std::mutex one_at_a_time;
    parallel_for(tiles_.size(), [&](std::size_t i) {
        if (stopped) return;
        const auto hits = buffers_.lease();
        body(i, *hits);
        const std::unique_lock<std::mutex> lock(one_at_a_time, std::try_to_lock);
        if (lock && !stopped && !keep_going_(what)) stopped = true;
    });
    if (stopped) throw Error(ErrorKind::kRender, "interrupted");
    return milliseconds_since(start) / share_;
}

std::int64_t FrameWalk::samples() const {
    std::int64_t pixels = 0;
    for (const Tile& tile : tiles_) pixels += std::int64_t{tile.x1 - tile.x0} * (tile.y1 - tile.y0);
    return pixels * samples_.spp();
}

void FrameWalk::make_reference() {
    const Visibility visibility = processors_own("none");
    reference_.resize(tiles_.size());
    for_each_tile("none: the reference", [&](std::size_t i, Hits&) {
        CoverCounts counts;
        visibility.cover(tiles_[i], reference_[i], counts);
    });
}

std::int64_t FrameWalk::reference_bytes() const {
    std::size_t bytes = 0;
    for (const Hits& hits : reference_)
        bytes += hits.depth.capacity() * sizeof(float) + hits.triangle.capacity() * sizeof(std::uint32_t);
    return static_cast<std::int64_t>(bytes);
}

FrameWalk::Counts FrameWalk::count(const std::string& method, MethodMap* map) {
    const View& view = frame_.view;
    const int slots = samples_.slots();
    if (map != nullptr) {
        const std::size_t pixels = static_cast<std::size_t>(view.width) * view.height;
        *map = {method,
                {view.width, view.height, std::vector<std::uint32_t>(pixels), std::vector<std::uint32_t>(pixels)},
                std::vector<std::uint32_t>(pixels)};
    }
    const bool depths = !has_own_arithmetic(method);
    Counts result;
    Adder adder(result.cover);
    std::atomic<std::int64_t> all_lost{0};
    const auto start = Clock::now();
    const Visibility visibility = visibility_of(method);
    const double bins_ms = milliseconds_since(start);
    const double tiles_ms = for_each_tile(method + ": counting", [&](std::size_t i, Hits& hits) {
        CoverCounts counts;
        visibility.cover(tiles_[i], hits, counts, map != nullptr ? &map->cover : nullptr);
        std::int64_t lost = 0;
        for_each_sample(tiles_[i], hits, slots, [&](int px, int py, std::size_t s) {
            if (!differ(hits, reference_[i], s, depths)) return;
            ++lost;
            if (map != nullptr) ++map->lost[static_cast<std::size_t>(py) * view.width + px];
        });
        all_lost += lost;
        adder.add(counts);
    });
    result.lost = all_lost;
    result.gl_pipeline = visibility.gl_pipeline();
    result.frame_ms = bins_ms + tiles_ms;
    return result;
}

FrameWalk::Timed FrameWalk::time_frame(const std::string& method) {
    Timed timed;
    Adder adder(timed.cover);
    const auto start = Clock::now();
    const Visibility visibility = visibility_of(method);
    timed.ms = milliseconds_since(start);
    timed.ms += for_each_tile(method + ": timing", [&](std::size_t i, Hits& hits) {
        CoverCounts counts;
        visibility.cover(tiles_[i], hits, counts);
        adder.add(counts);
    });
    return timed;
}

FrameWalk::Timed FrameWalk::time_setup(const std::string& method) {
    Timed timed;
    const MethodSettings settings = settings_of(method, settings_);
    const auto start = Clock::now();
    if (settings.culling == "auto" || settings.backend != Backend::kCpu) {
        const Visibility visibility = visibility_of(method);
        timed.ms = milliseconds_since(start);
        return timed;
    }
    const Bins bins(frame_, settings_.tile_size, whole(frame_));
    timed.ms = milliseconds_since(start);
    Adder adder(timed.cover);
    const Culling culling = refusing(parse_culling(settings.culling));
    timed.ms += for_each_tile(method + ": timing its questions", [&](std::size_t i, Hits& hits) {
        const Tile& tile = tiles_[i];
        hits.reset(samples_.slots(), tile);
        CoverCounts counts;
        cover_with_test({frame_, samples_, bins.triangles(), bins.tile(tile.x0, tile.y0), tile, nullptr}, culling, hits,
                        counts);
        adder.add(counts);
    });
    return timed;
}

BenchCell FrameWalk::describe() {
    struct Sums {
        double samples = 0, hits = 0, motion = 0, blur = 0;
    };
    const Visibility visibility = processors_own(samples_.pattern() == SamplePattern::kFree ? "auto" : "none");
    const std::vector<Tile>& all = visibility.tiles();
    std::vector<Sums> sums(all.size());  // added up in the order of tiles, so that the result is always the same
    parallel_for(all.size(), [&](std::size_t i) {
        const auto hits = buffers_.lease();
        CoverCounts counts;
        visibility.cover(all[i], *hits, counts);
        for_each_sample(all[i], *hits, samples_.slots(), [&](int px, int py, std::size_t s) {
            if ((px + py) % 4 != 0) return;  // a quarter of the pixels says as much
            ++sums[i].samples;
            const std::uint32_t triangle = hits->triangle[s];
            if (triangle == kNoTriangle) return;
            ++sums[i].hits;
            const Seen open = middle_at(frame_, triangle, 0),
                       close = middle_at(frame_, triangle, frame_.parts[frame_.part_of[triangle]].segments);
            sums[i].motion += std::hypot(close.x - open.x, close.y - open.y);
            sums[i].blur += 0.5 * (open.radius + close.radius);
        });
    });
    Sums sum;
    for (const Sums& s : sums) sum.samples += s.samples, sum.hits += s.hits, sum.motion += s.motion, sum.blur += s.blur;
    BenchCell cell;
    cell.share = share_;
    if (sum.hits > 0) {
        cell.motion_px = sum.motion / sum.hits;
        cell.blur_px = sum.blur / sum.hits;
        cell.hit = sum.hits / sum.samples;
    }
    return cell;
}

}  // namespace pentaprism
