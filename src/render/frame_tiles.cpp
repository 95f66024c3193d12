#include "render/frame_tiles.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/parallel.h"
#include "render/picture_rows.h"

namespace pentaprism {
namespace {

using Clock = std::chrono::steady_clock;

// Milliseconds since it was asked last.
class Lap {
  public:
    double operator()() {
        const Clock::time_point now = Clock::now();
        return std::chrono::duration<double, std::milli>(now - std::exchange(last_, now)).count();
    }

  private:
    Clock::time_point last_ = Clock::now();
};

PixelRect crop_of(const ImageSettings& image) {
    if (!image.crop) return {0, image.width, 0, image.height};
    return {(*image.crop)[0], (*image.crop)[1], (*image.crop)[2], (*image.crop)[3]};
}

// glm matrices are column-major, as FrameInfo's.
void copy_matrix(const glm::dmat4& matrix, std::array<double, 16>& out) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) out[4 * column + row] = matrix[column][row];
}

glm::vec3 background_of(const Scene& scene, const ImageSettings& image) {
    if (image.background) return {(*image.background)[0], (*image.background)[1], (*image.background)[2]};
    return scene.background.value_or(glm::vec3(0.0f));
}

ShadingRate rate_of(const std::string& name) {
    return name == "sample" ? ShadingRate::kSample : name == "pixel" ? ShadingRate::kPixel : ShadingRate::kDecoupled;
}

bool asks(const ImageSettings& image, std::initializer_list<Aov> some) {
    return std::any_of(some.begin(), some.end(), [&](Aov aov) {
        return std::find(image.aovs.begin(), image.aovs.end(), aov) != image.aovs.end();
    });
}

// The cells of that part and a block around them, as far as the picture goes.
PixelRect cells_and_a_block(const PixelRect& part, const FrameInfo& info) {
    const auto begin = [](int at) { return std::max(0, at / kCellSize * kCellSize - kBlockSize); };
    const auto end = [](int at, int size) {
        return std::min(size, (at + kCellSize - 1) / kCellSize * kCellSize + kBlockSize);
    };
    return {begin(part.x0), end(part.x1, info.width), begin(part.y0), end(part.y1, info.height)};
}

template <class T>
const T* pointer_to(const std::optional<T>& value) {
    return value ? &*value : nullptr;
}

std::int64_t nanoseconds(Clock::duration duration) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
}

}  // namespace

FrameTiles::FrameTiles(const Scene& scene, const KeptParts& kept, const RenderSettings& settings, double number)
    : settings_(settings), filter_(settings.image.filter, background_of(scene, settings.image)) {
    Lap lap;
    const View view = make_view(scene, settings, number);
    const std::vector<Index> animations = choose_animations(scene, settings.animation.animation);
    frame_ = pose_frame(scene, view, animations, settings.shutter);
    frame_.textures = kept.textures;
    pose_ms_ = lap();
    if (settings.image.target_error) {
        settings_.method.tile_size = kCellSize;  // what a budget counts in
        budget_.emplace(settings.image, settings.method.sampler, background_of(scene, settings.image));
        MethodSettings pilot = settings.method;
        pilot.seed = SampleBudget::pilot_seed(pilot.seed);
        samples_.emplace(make_samples(frame_, SampleBudget::kPilotSpp, pilot));
        for_levels_.resize(budget_->levels().size());
    } else {
        samples_.emplace(make_samples(frame_, settings.image.spp, settings.method));
    }
    samples_ms_ = lap();
    info_ = describe(animations, number);
    const PixelRect part = rendered_part(info_, filter_.reach());
    tiles_ = tiles_over(part, settings_.method.tile_size);
    visibility_.emplace(frame_, *samples_, settings_.method, budget_ ? cells_and_a_block(part, info_) : part);
    bin_ms_ = lap();
    const MethodSettings& method = settings.method;
    shading_.emplace(frame_, ShadingOptions{method.shadows, method.brdf, method.texture_filter, rate_of(method.shading),
                                            kept.environment});
    device_shades_ = method.backend == Backend::kGl && shading_->options().rate == ShadingRate::kPixel;
    if (device_shades_) visibility_->shade_with(*shading_);
    prepare_ms_ = lap();
    make_aovs(number);
}

FrameInfo FrameTiles::describe(std::span<const Index> animations, double number) const {
    const View& view = frame_.view;
    const PixelRect crop = crop_of(settings_.image);
    FrameInfo info;
    info.width = view.width;
    info.height = view.height;
    info.x0 = crop.x0, info.x1 = crop.x1, info.y0 = crop.y0, info.y1 = crop.y1;
    info.frame = number;
    info.fps = settings_.animation.fps;
    info.shutter_open = view.shutter.open;
    info.shutter_close = view.shutter.close;
    info.readout = view.shutter.readout();
    info.lens_radius = view.lens.radius;
    info.focus_distance = view.lens.focus_distance;
    info.fstop = view.lens.fstop;
    info.focal_length_mm = view.focal_length_mm;
    info.camera = view.camera_name;
    for (const Part& part : frame_.parts) info.max_motion_segments = std::max(info.max_motion_segments, part.segments);
    const glm::dmat4 to_camera = world_to_camera(view, frame_.middle);
    glm::dmat4 projection(0.0);
    projection[0][0] = view.fx * 2.0 / view.width;
    projection[1][1] = view.fy * 2.0 / view.height;
    projection[2][2] = -1.0;
    projection[2][3] = view.perspective ? -1.0 : 0.0;
    projection[3][3] = view.perspective ? 0.0 : 1.0;
    info.fx = view.fx;
    info.fy = view.fy;
    copy_matrix(to_camera, info.world_to_camera);
    copy_matrix(projection * to_camera, info.world_to_ndc);
    const bool one_instant = view.shutter.close == view.shutter.open;
    info.knots.resize(one_instant ? 1 : static_cast<std::size_t>(info.max_motion_segments) + 1);
    parallel_for(info.knots.size(), [&](std::size_t k) {
        FrameInfo::Knot& knot = info.knots[k];
        knot.time = view.shutter.at(static_cast<double>(k) / info.max_motion_segments);
        const Pose pose = evaluate(*frame_.scene, animations, knot.time);
        copy_matrix(world_to_camera(view, pose), knot.world_to_camera);
        const View now = view_at(*frame_.scene, view, pose);
        knot.fx = now.fx, knot.fy = now.fy;
        knot.lens_radius = now.lens.radius, knot.focus_distance = now.lens.focus_distance;
    });
    return info;
}

void FrameTiles::make_aovs(double number) {
    const ImageSettings& image = settings_.image;
    if (image.aovs.empty()) return;
    if (asks(image, {Aov::kObjectId, Aov::kMaterialId, Aov::kCryptomatte, Aov::kTime})) ids_.emplace(frame_);
    if (asks(image, {Aov::kMotion})) flow_.emplace(*frame_.scene, settings_, number);
    if (asks(image, {Aov::kOcclusion})) occlusion_.emplace(frame_, settings_, number);
    if (asks(image, {Aov::kSte})) {
        const std::size_t pixels = static_cast<std::size_t>(info_.width) * info_.height;
        tests_ = {info_.width, info_.height, std::vector<std::uint32_t>(pixels), std::vector<std::uint32_t>(pixels)};
    }
    const AovSources sources{&*shading_,
                             pointer_to(ids_),
                             pointer_to(flow_),
                             pointer_to(occlusion_),
                             pointer_to(tests_),
                             background_of(*frame_.scene, image),
                             static_cast<float>(std::exp2(image.exposure))};
    aovs_.emplace(image.aovs, sources, delivered_part(info_));

    // Names of what the numbers in a picture stand for.
    info_.aovs = image.aovs;
    for (const Aov aov : image.aovs) {
        if (aov == Aov::kObjectId) info_.attributes.emplace_back("objects", ids_->objects.json());
        if (aov == Aov::kMaterialId) info_.attributes.emplace_back("materials", ids_->materials.json());
        if (aov != Aov::kCryptomatte) continue;
        for (const auto& attribute : ids_->objects.cryptomatte_attributes("CryptoObject"))
            info_.attributes.push_back(attribute);
        for (const auto& attribute : ids_->materials.cryptomatte_attributes("CryptoMaterial"))
            info_.attributes.push_back(attribute);
    }
}

int FrameTiles::delivered_pixels(const Tile& tile) const {
    int pixels = 0;
    for (int y = std::max(tile.y0, info_.y0); y < std::min(tile.y1, info_.y1); ++y)
        for (int x = std::max(tile.x0, info_.x0); x < std::min(tile.x1, info_.x1); ++x)
            pixels += tile.wants(x / kBlockSize, y / kBlockSize);
    return pixels;
}

void FrameTiles::cover_and_shade(const Tile& tile, const SampleTable& samples, Worker& worker, bool to_decide) {
    if (settings_.method.transparency == Transparency::kABuffer) return cover_and_shade_layers(tile, samples, worker);
    const auto start = Clock::now();
    CoverCounts counts;
    visibility_->cover(tile, samples, worker.hits, counts, tests_ && !to_decide ? &*tests_ : nullptr);
    const auto covered = Clock::now();
    costs_.shaded += shade(tile, samples, worker, to_decide);
    costs_.cover_ns += nanoseconds(covered - start);
    costs_.shade_ns += nanoseconds(Clock::now() - covered);
    costs_.tested += counts.tested;
    costs_.covered += counts.covered;
}

std::int64_t FrameTiles::shade(const Tile& tile, const SampleTable& samples, Worker& worker, bool roughly) const {
    if (!device_shades_) return worker.shader.shade(*shading_, samples, tile, worker.hits, worker.shade, roughly);
    const std::int64_t points = visibility_->shade(tile, worker.hits, worker.shade);
    worker.shader.shade_misses(*shading_, samples, tile, worker.hits, worker.shade);
    return points;
}

// Its time counts as shading: coverage comes in between.
void FrameTiles::cover_and_shade_layers(const Tile& tile, const SampleTable& samples, Worker& worker) {
    const auto start = Clock::now();
    CoverCounts counts;
    costs_.shaded +=
        worker.layers.shade(*visibility_, *shading_, samples, tile, background_of(*frame_.scene, settings_.image),
                            worker.hits, worker.shade, counts);
    costs_.shade_ns += nanoseconds(Clock::now() - start);
    costs_.tested += counts.tested;
    costs_.covered += counts.covered;
}

void FrameTiles::add_samples(const Tile& tile, const SampleTable& samples, Worker& worker) {
    cover_and_shade(tile, samples, worker, false);
    const auto start = Clock::now();
    worker.sums.tile.blocks = tile.blocks;
    filter_.add(samples, worker.hits, worker.shade, worker.sums);
    if (aovs_) aovs_->resolve(samples, worker.hits, worker.shade, worker.aovs, worker.sums);
    costs_.resolve_ns += nanoseconds(Clock::now() - start);
    const int pixels = delivered_pixels(tile);
    costs_.pixels += pixels;
    costs_.samples += std::int64_t{pixels} * samples.spp();
}

const SampleTable& FrameTiles::samples_of_level(std::size_t level) {
    const std::lock_guard<std::mutex> lock(making_);
    std::optional<SampleTable>& samples = for_levels_[level];
    if (samples) return *samples;
    const auto start = Clock::now();
    isolated([&] { samples.emplace(make_samples(frame_, budget_->levels()[level], settings_.method)); });
    costs_.tables_ns += nanoseconds(Clock::now() - start);
    return *samples;
}

std::vector<Tile> FrameTiles::tiles_to_decide(std::span<const Tile> tiles) const {
    if (!budget_) return {};
    return budget_->tiles_to_know(tiles, visibility_->tiles());
}

void FrameTiles::decide(const Tile& tile, Worker& worker) {
    cover_and_shade(tile, *samples_, worker, true);
    budget_->note(tile, *samples_, worker.hits, worker.shade);
    costs_.pilot_samples += std::int64_t{delivered_pixels(tile)} * samples_->spp();
}

void FrameTiles::render(const Tile& tile, Worker& worker) {
    worker.sums.start(tile, filter_.reach(), channel_count(info_.aovs));
    if (!budget_) return add_samples(tile, *samples_, worker);
    const auto blocks = budget_->share_out(tile);
    for (std::size_t level = 0; level < blocks.size(); ++level) {
        Tile part = tile;
        part.blocks = blocks[level];
        if (part.wanted_blocks() == 0) continue;  // a crop may leave none of a level's blocks in the tile
        add_samples(part, samples_of_level(level), worker);
    }
}

void FrameTiles::store(const Tile& tile, Worker& worker) {
    cover_and_shade(tile, *samples_, worker, false);
    const auto start = Clock::now();
    store_samples(tile, *samples_, worker.hits, worker.shade, background_of(*frame_.scene, settings_.image),
                  worker.samples);
    costs_.resolve_ns += nanoseconds(Clock::now() - start);
    const int pixels = delivered_pixels(tile);
    costs_.pixels += pixels;
    costs_.samples += std::int64_t{pixels} * samples_->spp();
}

void FrameTiles::fill(RenderStats& stats) const {
    const double per_thread = 1e-6 / thread_count();
    const double cover_ms = static_cast<double>(costs_.cover_ns) * per_thread;
    stats.times_ms = {{"pose", pose_ms_},
                      {"samples", samples_ms_ + 1e-6 * static_cast<double>(costs_.tables_ns)},
                      {"bin", bin_ms_},
                      {"prepare_shading", prepare_ms_},
                      {"cover", cover_ms},
                      {"visibility", bin_ms_ + cover_ms},
                      {"shade", static_cast<double>(costs_.shade_ns) * per_thread},
                      {"resolve", static_cast<double>(costs_.resolve_ns) * per_thread}};
    stats.triangles = frame_.triangle_count();
    stats.moving_triangles = 0;
    for (const Part& part : frame_.parts)
        stats.moving_triangles += std::int64_t{part.triangle_count} * (part.moves ? part.segments : 1);
    stats.samples = costs_.samples;
    stats.pilot_samples = costs_.pilot_samples;
    stats.pixels = costs_.pixels;
    stats.tested = costs_.tested;
    stats.covered = costs_.covered;
    stats.shaded = costs_.shaded;
    stats.gl_pipeline = visibility_->gl_pipeline();
}

}  // namespace pentaprism
