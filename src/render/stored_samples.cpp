// Pictures of stored samples. What a pinhole shows at p is seen through the point u of the lens at x = p + u (a/w + b),
// with b = A f_px / F (camera/view.h). So the ray that the focus F puts at x, the focus F' puts at
// x + u A f_px (1/F' - 1/F), whatever it hits. Rays are even over lens, time and screen before and after: weighted
// means of them are the new picture.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <pentaprism/error.h>
#include <pentaprism/stored_samples.h>

#include "base/parallel.h"
#include "base/pool.h"
#include "render/picture_rows.h"
#include "render/shard_stream.h"
#include "resolve/filter.h"
#include "resolve/stored_sample.h"
#include "sample/sample_times.h"

namespace pentaprism {

struct StoredSamples::Stream : TileInput {
    explicit Stream(std::unique_ptr<ByteSource> source) : TileInput(StreamKind::kSamples, std::move(source)) {}
};

namespace {

constexpr double kFarthest = 256.0;  // pixels
constexpr double kRounding = 1e-9;   // of what may be asked for, beyond what was recorded
constexpr std::size_t kRunSamples = 1 << 22;

[[noreturn]] void refuse(const std::string& why) {
    throw Error(ErrorKind::kUsage, why);
}

// Which rays the lens lets in, and where they go.
class Lensing {
  public:
    Lensing(const StreamHead& head, const Development& wanted) {
        const FrameInfo& info = head.info;
        if (!wanted.focus_distance && !wanted.fstop) return;
        if (!(info.lens_radius > 0.0))
            refuse("the samples were rendered through a pinhole: there is no focus to change");
        if (!head.camera.perspective) refuse("an orthographic camera's rays belong to its focus");
        if (!head.camera.thin_lens)
            refuse(
                "the samples were rendered with --focus-range, --max-foreground-blur, --tilt or --swing, or while zoom "
                "or focus moved: their rays belong to that lens");
        if (wanted.fstop) {
            if (!std::isfinite(*wanted.fstop)) refuse(fmt::format("--fstop: {} is not a finite number", *wanted.fstop));
            if (!(info.fstop > 0.0 && *wanted.fstop >= info.fstop * (1.0 - kRounding)))
                refuse(
                    fmt::format("--fstop {}: the samples were rendered at {}; a larger aperture has rays that they "
                                "lack",
                                *wanted.fstop, info.fstop));
            if (!head.camera.round)
                refuse("--fstop: only a round aperture becomes smaller, not one with blades, a picture or a cat's eye");
            const double radius = std::min(1.0, info.fstop / *wanted.fstop);
            if (radius < 1.0) radius2_ = radius * radius;
        }
        if (wanted.focus_distance) {
            if (!(*wanted.focus_distance > 0.0) || !std::isfinite(*wanted.focus_distance))
                refuse(fmt::format("--focus-distance: {} is not above 0", *wanted.focus_distance));
            move_x_ = info.lens_radius * info.fx * (1.0 / *wanted.focus_distance - 1.0 / info.focus_distance);
            move_y_ = -move_x_ * head.camera.lens_ratio;  // v counts up, rows down
        }
        if (reach() > kFarthest)
            refuse(fmt::format("--focus-distance {}: samples would move by {:.0f} pixels, over {:.0f}",
                               *wanted.focus_distance, reach(), kFarthest));
    }
    /// Pixels.
    double reach() const { return std::max(std::abs(move_x_), std::abs(move_y_)) * std::sqrt(std::min(1.0, radius2_)); }
    bool lets_in(const StoredSample& s) const { return s.u * s.u + s.v * s.v <= radius2_; }
    TileFilter::SubPixel place(const StoredSample& s, int px, int py) const {
        return {px * 256 + s.x + static_cast<int>(std::lround(256.0 * move_x_ * s.u)),
                py * 256 + s.y + static_cast<int>(std::lround(256.0 * move_y_ * s.v))};
    }

  private:
    double move_x_ = 0.0, move_y_ = 0.0;  // pixels at the rim of the lens
    double radius2_ = 4.0;                // of the part of the unit disk that is open, squared; rounding lies within
};

// How much of the light of a time the shutter lets in, at each place. All in shares of the recorded open time.
class Shuttering {
  public:
    Shuttering(const StreamHead& head, const Development& wanted) : curve_(wanted.curve) {
        const FrameInfo& info = head.info;
        if (!wanted.shutter && wanted.shutter_offset == 0.0 && curve_.empty() &&
            wanted.rolling == RollingShutter::kNone)
            return;
        const double recorded = (info.shutter_close - info.shutter_open) * info.fps;  // frames
        if (!head.camera.even_shutter)
            refuse("the samples were rendered with a rolling shutter or a curve: their times cannot be chosen again");
        if (!(recorded > 0.0)) refuse("the samples were rendered at one instant: there is no time to choose");
        const double open = wanted.shutter.value_or(recorded);
        const double readout = wanted.rolling == RollingShutter::kNone ? 0.0 : wanted.rolling_duration;
        if (!(open > 0.0) || !(readout >= 0.0) || !std::isfinite(open + readout + wanted.shutter_offset))
            refuse("--shutter wants frames above 0, --rolling-shutter-duration 0 or more");
        if (0.5 * (open + readout) + std::abs(wanted.shutter_offset) > 0.5 * recorded * (1.0 + kRounding))
            refuse(fmt::format("--shutter: {} frames, {} for the rows and {} aside are more than the recorded {}", open,
                               readout, wanted.shutter_offset, recorded));
        RenderSettings as_rendered;
        as_rendered.shutter.curve = curve_;
        validate(as_rendered);
        all_ = false;
        exposure_ = open / recorded;
        whole_ = (open + readout) / recorded;
        start_ = 0.5 + wanted.shutter_offset / recorded - 0.5 * whole_;
        Shutter rows;
        rows.rolling = readout > 0.0 ? wanted.rolling : RollingShutter::kNone;
        rows.exposure_share = open / (open + readout);
        times_ = SampleTimes(rows, info.width, info.height);
        open_s_ = info.shutter_open + start_ * (info.shutter_close - info.shutter_open);
    }

    double weight(float t, const TileFilter::SubPixel& at) const {
        if (all_) return 1.0;
        const double row = start_ + whole_ * times_.at(0.0f, at.x / 256.0, at.y / 256.0);
        const double s = (t - row) / exposure_;
        if (!(s >= 0.0 && s < 1.0)) return 0.0;
        return curve_.empty() ? 1.0 : openness(s);
    }
    void describe(FrameInfo& info) const {
        if (all_) return;
        const double span = info.shutter_close - info.shutter_open;
        info.shutter_open = open_s_;
        info.shutter_close = open_s_ + whole_ * span;
        info.readout = (whole_ - exposure_) * span;
    }

  private:
    double openness(double s) const {
        const auto after = std::upper_bound(curve_.begin(), curve_.end(), s,
                                            [](double time, const ShutterPoint& point) { return time < point.t; });
        if (after == curve_.begin() || after == curve_.end()) return 0.0;
        const ShutterPoint &p = after[-1], &q = *after;
        return p.open + (q.open - p.open) * (s - p.t) / (q.t - p.t);
    }
    bool all_ = true;
    double exposure_ = 1.0, whole_ = 1.0, start_ = 0.0, open_s_ = 0.0;
    std::vector<ShutterPoint> curve_;
    SampleTimes times_;
};

struct Plan {
    Plan(const StreamHead& head, const Development& wanted)
        : spp(head.image.spp),
          reach(static_cast<int>(std::ceil(Lensing(head, wanted).reach())) + 1 + filter_reach(head.image.filter)),
          filter(head.image.filter, glm::vec3(0.0f)),
          lens(head, wanted),
          shutter(head, wanted) {}

    void add(const std::vector<StoredSample>& samples, TileSums& sums) const {
        const Tile& tile = sums.tile;
        const StoredSample* sample = samples.data();
        for (int y = tile.y0; y < tile.y1; ++y)
            for (int x = tile.x0; x < tile.x1; ++x)
                for (int index = 0; index < spp; ++index, ++sample) {
                    float& depth = sums.depth[sums.own(x, y)];
                    depth = std::min(depth, sample->depth);
                    if (!lens.lets_in(*sample)) continue;
                    const TileFilter::SubPixel at = lens.place(*sample, x, y);
                    const double weight = shutter.weight(sample->t, at);
                    if (weight > 0.0)
                        filter.add_sample(
                            at,
                            {sample->color[0], sample->color[1], sample->color[2], static_cast<float>(sample->opaque)},
                            weight / spp, sums);
                }
    }

    int spp, reach;
    TileFilter filter;
    Lensing lens;
    Shuttering shutter;
};

FrameInfo developed_info(const StreamHead& head, const Development& wanted, const Plan& plan) {
    FrameInfo info = head.info;
    info.focus_distance = wanted.focus_distance.value_or(info.focus_distance);
    if (wanted.fstop) {
        info.lens_radius *= info.fstop / *wanted.fstop;
        info.fstop = *wanted.fstop;
    }
    plan.shutter.describe(info);
    return info;
}

// Damaged numbers must not lead out of the tile's ring.
void contain(std::vector<StoredSample>& samples) {
    for (StoredSample& s : samples)
        if (!(s.u * s.u + s.v * s.v <= 1.0001f)) s.u = s.v = 0.0f;
}

}  // namespace

StoredSamples::StoredSamples(std::unique_ptr<ByteSource> source)
    : stream_(std::make_unique<Stream>(std::move(source))) {}
StoredSamples::~StoredSamples() = default;

const FrameInfo& StoredSamples::info() const {
    return stream_->head().info;
}
const FileMetadata& StoredSamples::metadata() const {
    return stream_->head().metadata;
}
const ImageSettings& StoredSamples::image() const {
    return stream_->head().image;
}

double StoredSamples::reach(const Development& development) const {
    return Lensing(stream_->head(), development).reach();
}

void StoredSamples::develop(const Development& development, RowSink& sink) {
    const StreamHead& head = stream_->head();
    const Plan plan(head, development);
    const std::vector<Tile> tiles = tiles_over(rendered_part(info(), filter_reach(image().filter)), kCellSize);
    PictureRows picture(developed_info(head, development, plan), plan.reach, image().exposure, sink);
    const std::size_t run = std::max<std::size_t>(1, kRunSamples / (kCellSize * kCellSize) / plan.spp);
    std::vector<std::vector<StoredSample>> samples(run);
    Pool<TileSums> pool;
    picture.assemble(tiles, [&](std::size_t first, std::size_t last) {
        for (std::size_t begin = first; begin < last; begin += run) {
            const std::size_t count = std::min(run, last - begin);
            for (std::size_t i = 0; i < count; ++i) {
                const Tile& tile = tiles[begin + i];
                samples[i].resize(static_cast<std::size_t>(tile.x1 - tile.x0) * (tile.y1 - tile.y0) * plan.spp);
                stream_->read(samples[i]);
                contain(samples[i]);
            }
            parallel_for(count, [&](std::size_t i) {
                const auto sums = pool.lease();
                sums->start(tiles[begin + i], plan.reach, 0);
                plan.add(samples[i], *sums);
                picture.add(*sums);
            });
        }
    });
    stream_->finish();
}

}  // namespace pentaprism
