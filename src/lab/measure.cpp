// Counting and timing are apart: one run of each method counts and compares every hit with that of `none`; then all
// methods are timed in turn, round after round, so that what else the machine does hits them alike, and medians count.
//
// The time of a culling test is split by a second kind of run, in turn with the first: the same walk over the same
// triangles, pixels and samples, each question asked, but every sample refused in the end, so that no exact test
// follows.

#include "lab/measure.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <mutex>
#include <pentaprism/error.h>

#include "base/parallel.h"
#include "base/pool.h"
#include "lab/machine.h"

namespace pentaprism {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

// The test that a walk without exact tests asks before it refuses; one walk at a time.
const CullTest* asked_test = nullptr;

bool prepare_asked(const LocalTriangle& triangle, const Footprint& footprint, CullState& state) {
    return asked_test->prepare(triangle, footprint, state);
}
bool ask_and_refuse(const CullState& state, const LocalSample& sample) {
    asked_test->keeps(state, sample);
    return false;
}
constexpr CullTest kRefuse{"refuse", "", prepare_asked, ask_and_refuse};

PixelRect whole(const PosedPicture& picture) {
    return {0, picture.frame.view.width, 0, picture.frame.view.height};
}

// True for lanes of a tile's hits that are pixels of the picture.
template <class Body>
void for_each_sample(const Tile& tile, int slots, const Body& body) {
    for (int py = tile.y0; py < tile.y1; ++py)
        for (int px = tile.x0; px < tile.x1; ++px) {
            const int block = py % kCellSize / kBlockSize * kCellBlocks + px % kCellSize / kBlockSize;
            const int lane = py % kBlockSize * kBlockSize + px % kBlockSize;
            for (int slot = 0; slot < slots; ++slot)
                body(px, py, (static_cast<std::size_t>(block) * slots + slot) * kLanes + lane);
        }
}

std::int64_t differing_samples(const Tile& tile, int slots, const Hits& a, const Hits& b) {
    std::int64_t count = 0;
    for_each_sample(tile, slots, [&](int, int, std::size_t s) {
        count += a.triangle[s] != b.triangle[s] || std::memcmp(&a.depth[s], &b.depth[s], sizeof(float)) != 0;
    });
    return count;
}

// A tile's triangle at one end of the shutter, in pixels, with its circle of confusion there.
struct Seen {
    double x, y, radius;
};
Seen middle_at(const Frame& frame, std::uint32_t triangle, int knot) {
    const Part& part = frame.parts[frame.part_of[triangle]];
    Seen seen{0, 0, 0};
    for (int corner = 0; corner < 3; ++corner) {
        const std::size_t moved = part.moves ? static_cast<std::size_t>(knot) * part.vertex_count : 0;
        const glm::vec4& p = frame.points[frame.corners[3 * triangle + corner] + moved];
        const double w = std::max(1e-3f, p.z);
        seen.x += p.x / w / 3;
        seen.y += p.y / w / 3;
        seen.radius += std::abs(p.w) / w / 3;
    }
    return seen;
}

class Bench {
  public:
    Bench(const PosedPicture& picture, const MeasureOptions& options, const KeepGoing& keep_going)
        : picture_(picture), options_(options), keep_going_(keep_going) {}

    // Hits of `none`; everything is compared with them.
    void make_reference() {
        const Visibility visibility = visibility_of("none");
        tiles_ = visibility.tiles();
        reference_ = std::make_unique<ReferenceHits>(tiles_.size());
        for_each_tile("none: the reference", [&](std::size_t i, Hits&) {
            CoverCounts counts;
            visibility.cover(tiles_[i], reference_->tile(i), counts);
        });
    }

    void count(BenchRow& row) {
        reset_peak_memory();
        std::atomic<std::int64_t> tested{0}, covered{0}, different{0};
        const auto start = Clock::now();
        const Visibility visibility = visibility_of(row.method);
        for_each_tile(row.method + ": counting", [&](std::size_t i, Hits& hits) {
            CoverCounts counts;
            visibility.cover(tiles_[i], hits, counts);
            tested += counts.tested;
            covered += counts.covered;
            different += differing_samples(tiles_[i], picture_.samples.slots(), hits, reference_->tile(i));
        });
        row.frame_ms = milliseconds_since(start);
        row.tested = tested;
        row.covered = covered;
        row.false_culls = different;
        row.samples = std::int64_t{picture_.frame.view.width} * picture_.frame.view.height * picture_.samples.spp();
        row.peak_mb = static_cast<double>(peak_memory() - reference_->bytes()) / (1024.0 * 1024.0);
    }

    double time_frame(const std::string& method) {
        const auto start = Clock::now();
        const Visibility visibility = visibility_of(method);
        for_each_tile(method + ": timing", [&](std::size_t i, Hits& hits) {
            CoverCounts counts;
            visibility.cover(tiles_[i], hits, counts);
        });
        return milliseconds_since(start);
    }

    double time_setup(const std::string& method) {
        const auto start = Clock::now();
        const Bins bins(picture_.frame, options_.method.tile_size, whole(picture_));
        asked_test = find_cull_test(method);
        if (asked_test == nullptr) return milliseconds_since(start);
        for_each_tile(method + ": timing its questions", [&](std::size_t i, Hits& hits) {
            const Tile& tile = tiles_[i];
            hits.reset(picture_.samples.slots());
            CoverCounts counts;
            cover_with_test({picture_.frame, picture_.samples, bins.triangles(), bins.tile(tile.x0, tile.y0), tile},
                            kRefuse, hits, counts);
        });
        return milliseconds_since(start);
    }

    BenchCell describe() const {
        BenchCell cell;
        double samples = 0, hits = 0;
        const Frame& frame = picture_.frame;
        for (std::size_t i = 0; i < tiles_.size(); ++i)
            for_each_sample(tiles_[i], picture_.samples.slots(), [&](int px, int py, std::size_t s) {
                if ((px + py) % 4 != 0) return;  // a quarter of the pixels says as much
                ++samples;
                const std::uint32_t triangle = reference_->tile(i).triangle[s];
                if (triangle == kNoTriangle) return;
                ++hits;
                const Seen open = middle_at(frame, triangle, 0),
                           close = middle_at(frame, triangle, frame.parts[frame.part_of[triangle]].segments);
                cell.motion_px += std::hypot(close.x - open.x, close.y - open.y);
                cell.blur_px += 0.5 * (open.radius + close.radius);
            });
        if (hits > 0) {
            cell.motion_px /= hits;
            cell.blur_px /= hits;
            cell.hit = hits / samples;
        }
        return cell;
    }

  private:
    Visibility visibility_of(const std::string& method) const {
        MethodSettings settings = options_.method;
        settings.culling = method;
        return Visibility(picture_.frame, picture_.samples, settings, whole(picture_));
    }

    template <class Body>
    void for_each_tile(const std::string& what, const Body& body) {
        std::atomic<bool> stopped{false};
        std::mutex one_at_a_time;
        parallel_for(tiles_.size(), [&](std::size_t i) {
            if (stopped) return;
            const auto hits = buffers_.lease();
            body(i, *hits);
            if (const std::unique_lock<std::mutex> lock(one_at_a_time, std::try_to_lock); lock && !keep_going_(what))
                stopped = true;
        });
        if (stopped) throw Error(ErrorKind::kRender, "interrupted");
    }

    const PosedPicture& picture_;
    const MeasureOptions& options_;
    const KeepGoing& keep_going_;
    std::vector<Tile> tiles_;
    std::unique_ptr<ReferenceHits> reference_;
    Pool<Hits> buffers_;
};

struct Times {
    std::vector<double> frame, setup;
    int planned = 1;
};

}  // namespace

std::int64_t ReferenceHits::bytes() const {
    std::int64_t bytes = 0;
    for (const Hits& hits : tiles_)
        bytes +=
            static_cast<std::int64_t>(hits.depth.size() * sizeof(float) + hits.triangle.size() * sizeof(std::uint32_t));
    return bytes;
}

std::vector<BenchRow> measure_methods(const PosedPicture& picture, const MeasureOptions& options, BenchCell& cell,
                                      const KeepGoing& keep_going) {
    Bench bench(picture, options, keep_going);
    bench.make_reference();
    const BenchCell described = bench.describe();
    cell.motion_px = described.motion_px;
    cell.blur_px = described.blur_px;
    cell.hit = described.hit;

    std::vector<BenchRow> rows;
    std::vector<Times> times;
    for (const std::string& method : options.methods) {
        BenchRow row;
        row.method = method;
        bench.count(row);
        // A frame and its questions make one round; the counting run told how long a frame takes.
        const double rounds = options.seconds * 1000.0 / std::max(1e-3, 2.0 * row.frame_ms);
        times.push_back({{}, {}, static_cast<int>(std::clamp(rounds, 1.0, static_cast<double>(options.runs)))});
        rows.push_back(std::move(row));
    }
    for (int round = 0; round < options.runs; ++round)
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const std::size_t i = (k + static_cast<std::size_t>(round)) % rows.size();  // nobody is always first
            if (round >= times[i].planned) continue;
            times[i].frame.push_back(bench.time_frame(rows[i].method));
            times[i].setup.push_back(bench.time_setup(rows[i].method));
        }
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].frame_ms = median(times[i].frame);
        rows[i].setup_ms = std::min(rows[i].frame_ms, median(times[i].setup));
        rows[i].test_ms = rows[i].frame_ms - rows[i].setup_ms;
        rows[i].runs = times[i].planned;
    }
    return rows;
}

}  // namespace pentaprism
