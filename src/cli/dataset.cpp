// Training data: `--dataset DIR`, one set of files for each frame, from one pass of the blurred frame and its sharp
// twins.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <pentaprism/aov.h>
#include <pentaprism/error.h>
#include <pentaprism/metadata.h>
#include <set>

#include "cli/frame_output.h"
#include "cli/progress.h"
#include "cli/resume.h"
#include "cli/tee.h"

namespace pentaprism::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// What a data set holds of a frame beside its colours.
const std::vector<Aov> kAovs{Aov::kDepth, Aov::kMotion, Aov::kCoc, Aov::kObjectId, Aov::kMaterialId, Aov::kCoverage};

const char* const kFolders[] = {"blur", "sharp",        "sharp-open", "sharp-close", "depth",
                                "flow", "flow-shutter", "coc",        "ids",         "frames"};

std::string dump(const Json& json) {
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

constexpr int kPasses = 4;  // of a frame: blurred and three times sharp

// Keeps the numbers of a frame as well.
class Collector : public Tee {
  public:
    using Tee::Tee;
    FrameInfo info;
    std::vector<float> depth, aovs;

    void begin(const FrameInfo& frame) override {
        info = frame;
        FrameInfo colour_alone = frame;
        colour_alone.aovs.clear();
        colour_alone.attributes.clear();
        Tee::begin(colour_alone);
        pixels_ = static_cast<std::size_t>(info.x1 - info.x0) * static_cast<std::size_t>(info.y1 - info.y0);
        depth.reserve(pixels_);
    }
    void rows(const PixelRows& band) override {
        Tee::rows(band);
        const std::size_t first = depth.size(), n = band.z.size(), channels = band.aovs.size() / n;
        depth.insert(depth.end(), band.z.begin(), band.z.end());
        aovs.resize(channels * pixels_);
        for (std::size_t c = 0; c < channels; ++c)
            std::copy_n(band.aovs.begin() + c * n, n, aovs.begin() + c * pixels_ + first);
    }
    /// The channels of an output variable.
    std::vector<DataPlane> planes(Aov wanted) const {
        std::vector<DataPlane> result;
        std::size_t channel = 0;
        for (const Aov aov : info.aovs)
            for (const ChannelInfo& about : aov_info(aov).channels) {
                if (aov == wanted)
                    result.push_back(
                        {about.name, about.whole_number, std::span(aovs).subspan(channel * pixels_, pixels_)});
                ++channel;
            }
        return result;
    }

  private:
    std::size_t pixels_ = 0;
};

// A sensor reads line by line: rows, or columns if it rolls from a side.
void describe_shutter(const FrameInfo& info, RollingShutter rolling, Json& json) {
    const double exposure = info.shutter_close - info.shutter_open - info.readout;
    const char* edge = rolling == RollingShutter::kTop      ? "top"
                       : rolling == RollingShutter::kBottom ? "bottom"
                       : rolling == RollingShutter::kLeft   ? "left"
                       : rolling == RollingShutter::kRight  ? "right"
                                                            : "none";
    const bool columns = rolling == RollingShutter::kLeft || rolling == RollingShutter::kRight;
    const int lines = info.readout > 0.0 ? (columns ? info.width : info.height) : 0;
    json["shutter_open_s"] = info.shutter_open;
    json["shutter_close_s"] = info.shutter_close;
    json["exposure_s"] = exposure;  // of one line
    json["rolling_shutter"] = lines > 0 ? edge : "none";
    json["readout_s"] = info.readout;
    json["readout_lines"] = lines;
    json["line_s"] = lines > 0 ? info.readout / lines : 0.0;
    json["exposure_lines"] = lines > 0 ? Json(exposure / (info.readout / lines)) : Json(nullptr);
}

Json camera_json(const FrameInfo& info, RollingShutter rolling) {
    Json json;
    json["frame"] = std::llround(info.frame);  // frames of a data set are whole numbers
    json["camera"] = info.camera;
    json["width"] = info.x1 - info.x0;
    json["height"] = info.y1 - info.y0;
    json["projection"] = info.focal_length_mm > 0.0 ? "perspective" : "orthographic";
    // Pixels from the upper left corner of the delivered part, y down.
    json["intrinsics"] = {
        {"fx", info.fx}, {"fy", info.fy}, {"cx", 0.5 * info.width - info.x0}, {"cy", 0.5 * info.height - info.y0}};
    json["focal_length_mm"] = info.focal_length_mm;
    json["lens_radius_m"] = info.lens_radius;
    json["fstop"] = info.fstop;
    json["focus_distance_m"] = info.focus_distance;
    describe_shutter(info, rolling, json);
    Json knots = Json::array();
    for (const FrameInfo::Knot& knot : info.knots)
        knots.push_back({{"time_s", knot.time},
                         {"world_to_camera_column_major", knot.world_to_camera},
                         {"fx", knot.fx},
                         {"fy", knot.fy},
                         {"lens_radius_m", knot.lens_radius},
                         {"focus_distance_m", knot.focus_distance}});
    json["knots"] = knots;
    return json;
}

// Of frames/NNNN.json; -1 for another name.
std::int64_t number_of(const fs::path& file) {
    const std::string text = file.stem().string();
    std::int64_t number = -1;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size() ? number : -1;
}

class Dataset : public FrameOutput {
  public:
    Dataset(const FrameSource& source, const fs::path& folder, const std::vector<std::int64_t>& frames,
            const std::optional<Shard>& shard)
        : source_(source), folder_(folder), all_(frames), shard_(shard) {
        source_.settings.image.aovs = kAovs;
        for (const char* kind : kFolders) {
            std::error_code error;
            fs::create_directories(folder_ / kind, error);
            if (error)
                throw Error(ErrorKind::kOutput, fmt::format("--dataset {}: cannot make the folder ({})",
                                                            (folder_ / kind).string(), error.message()));
        }
    }

    std::string name(std::int64_t frame) const override { return file("blur", frame, ".exr").string(); }
    bool exists(std::int64_t frame) const override { return fs::exists(file("frames", frame, ".json")); }
    void check_resumable(std::span<const std::int64_t> frames) override;
    void begin(std::span<const std::int64_t> frames) override;
    RenderStats render(Renderer& renderer, std::int64_t frame, const Progress& progress) override;
    void finish() override;

  private:
    fs::path file(const char* kind, std::int64_t frame, const char* suffix) const {
        return folder_ / kind / fmt::format("{:04}{}", frame, suffix);
    }
    void write_numbers(std::int64_t frame, const Collector& collector) const;
    void render_twins(Renderer& renderer, std::int64_t frame, const FrameInfo& blurred, const Progress& progress) const;
    void check(const fs::path& frame) const { check_made_with(frame, source_.metadata(source_.at(number_of(frame)))); }
    Json hashes_of(std::int64_t frame) const;
    std::vector<fs::path> whole_frames() const;
    void write_summary(const std::vector<fs::path>& frames) const;
    void write_shared(const char* name, const Json& json) const;

    FrameSource source_;
    fs::path folder_;
    std::vector<std::int64_t> all_;  // frames of all shards
    std::optional<Shard> shard_;
    bool renders_ = false, resumes_ = false;
};

// All that the manifest will cover, whether they are asked for now or not. Of many shards each reads its own frames
// alone, and the first one those that nobody is asked for.
void Dataset::check_resumable(std::span<const std::int64_t> frames) {
    resumes_ = true;
    for (const std::int64_t frame : frames) check(file("frames", frame, ".json"));
    if (shard_ && shard_->index != 0) return;
    const std::set<std::int64_t> asked(all_.begin(), all_.end());
    for (const fs::path& frame : whole_frames())
        if (!asked.contains(number_of(frame))) check(frame);
}

// While frames are made, what the folder says of all of them would be wrong.
void Dataset::begin(std::span<const std::int64_t> frames) {
    renders_ = !frames.empty();
    std::error_code ignored;
    for (const char* name : {"manifest.json", "camera.json"})
        if (renders_) fs::remove(folder_ / name, ignored);
}

RenderStats Dataset::render(Renderer& renderer, std::int64_t frame, const Progress& progress) {
    const RenderSettings settings = source_.at(frame);
    std::error_code ignored;
    fs::remove(file("frames", frame, ".json"), ignored);  // no longer whole
    Collector collector({file("blur", frame, ".exr"), file("blur", frame, ".png")}, settings.image,
                        source_.metadata(settings));
    RenderStats stats;
    renderer.render(settings, static_cast<double>(frame), collector, stats, part_of(progress, 0, kPasses));
    collector.finish();
    write_numbers(frame, collector);
    render_twins(renderer, frame, collector.info, progress);

    Json json = camera_json(collector.info, settings.shutter.rolling);
    for (const auto& [name, value] : collector.info.attributes)
        if (name == "objects" || name == "materials") json[name] = Json::parse(value);
    json["software"] = source_.software;
    json["settings"] = Json::parse(source_.metadata(settings).settings_json);
    json["files"] = hashes_of(frame);
    write_text_file(file("frames", frame, ".json"), dump(json));
    return stats;
}

// The sharp frames, and the flow between the first and the last moment.
void Dataset::render_twins(Renderer& renderer, std::int64_t frame, const FrameInfo& blurred,
                           const Progress& progress) const {
    RenderSettings settings = sharp_settings(source_.at(frame));
    const FileMetadata about = source_.metadata(settings);
    settings.image.flow_step = (blurred.shutter_close - blurred.shutter_open) * blurred.fps;
    settings.camera.offset_before = settings.camera.offset_after = settings.camera.offset;  // within one frame
    int pass = 1;
    const auto render = [&](const char* kind, SharpMoment moment) {
        auto twin = std::make_unique<Collector>(
            std::vector<fs::path>{file(kind, frame, ".exr"), file(kind, frame, ".png")}, settings.image, about);
        RenderStats ignored;
        renderer.render(settings, moment_of(blurred, moment), *twin, ignored, part_of(progress, pass++, kPasses));
        twin->finish();
        return twin;
    };
    render("sharp", SharpMoment::kMiddle);
    settings.image.aovs = {Aov::kMotion};
    const auto open = render("sharp-open", SharpMoment::kOpen), close = render("sharp-close", SharpMoment::kClose);
    const std::vector<DataPlane> there = open->planes(Aov::kMotion), back = close->planes(Aov::kMotion);
    const int width = blurred.x1 - blurred.x0, height = blurred.y1 - blurred.y0;
    const std::vector<DataPlane> planes{there[0], there[1], back[2], back[3]};
    write_data_exr(file("flow-shutter", frame, ".exr"), width, height, planes, about);
    write_flo(file("flow-shutter", frame, ".flo"), width, height, there[0], there[1]);
}

void Dataset::write_numbers(std::int64_t frame, const Collector& collector) const {
    const FrameInfo& info = collector.info;
    const FileMetadata about = source_.metadata(source_.at(frame));
    const int width = info.x1 - info.x0, height = info.y1 - info.y0;
    std::vector<DataPlane> depth{{"Z", false, collector.depth}};
    write_npy(file("depth", frame, ".npy"), width, height, depth);
    write_depth_png(file("depth", frame, ".png"), width, height, collector.depth);
    for (const Aov aov : {Aov::kDepth, Aov::kCoverage})
        for (const DataPlane& plane : collector.planes(aov)) depth.push_back(plane);
    write_data_exr(file("depth", frame, ".exr"), width, height, depth, about);
    const std::vector<DataPlane> flow = collector.planes(Aov::kMotion), coc = collector.planes(Aov::kCoc);
    write_data_exr(file("flow", frame, ".exr"), width, height, flow, about);
    write_flo(file("flow", frame, ".flo"), width, height, flow[0], flow[1]);
    write_data_exr(file("coc", frame, ".exr"), width, height, coc, about);
    write_npy(file("coc", frame, ".npy"), width, height, coc);
    std::vector<DataPlane> ids = collector.planes(Aov::kObjectId);
    ids.push_back(collector.planes(Aov::kMaterialId)[0]);
    write_data_exr(file("ids", frame, ".exr"), width, height, ids, about);
}

// What `xxh128sum` prints of each file of a frame, but for the one that will hold this.
Json Dataset::hashes_of(std::int64_t frame) const {
    Json hashes = Json::object();
    for (const char* kind : kFolders)
        for (const char* suffix : {".exr", ".png", ".npy", ".flo"})
            if (const fs::path path = file(kind, frame, suffix); fs::exists(path))
                hashes[path.lexically_relative(folder_).generic_string()] = scene_hash(path.string());
    return hashes;
}

std::vector<fs::path> Dataset::whole_frames() const {
    std::vector<fs::path> frames;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "frames"))
        if (entry.path().extension() == ".json" && number_of(entry.path()) >= 0) frames.push_back(entry.path());
    std::sort(frames.begin(), frames.end(),
              [](const fs::path& a, const fs::path& b) { return number_of(a) < number_of(b); });
    return frames;
}

// The last of many shards to end sees the frames of all, and reads them; the others leave at the first that is missing,
// which is found soon from the end. A shard that had nothing to do leaves the summary as it is.
void Dataset::finish() {
    if (!std::all_of(all_.rbegin(), all_.rend(), [&](std::int64_t frame) { return exists(frame); })) return;
    if (shard_ && !renders_ && fs::exists(folder_ / "manifest.json")) return;
    std::vector<fs::path> frames;
    do {
        frames = whole_frames();
        if (resumes_ && shard_) std::for_each(frames.begin(), frames.end(), [&](const fs::path& f) { check(f); });
        write_summary(frames);
    } while (frames != whole_frames());
}

// manifest.json and camera.json, over all frames that the folder holds whole.
void Dataset::write_summary(const std::vector<fs::path>& frames) const {
    Json cameras = Json::array(), files = Json::object();
    for (const fs::path& frame : frames) {
        std::ifstream in(frame);
        Json json = Json::parse(in, nullptr, false);
        if (!json.is_object() || !json.contains("files"))
            throw Error(ErrorKind::kOutput, fmt::format("{}: cannot read what a whole frame has; remove it and "
                                                        "render the frame again",
                                                        frame.string()));
        files.update(json["files"]);
        files[frame.lexically_relative(folder_).generic_string()] = scene_hash(frame.string());
        json.erase("files");
        cameras.push_back(std::move(json));
    }
    Json manifest;
    manifest["software"] = source_.software;
    manifest["settings"] =
        Json::parse(settings_json(source_.settings, source_.scene, source_.scene_hash, source_.pictures));
    if (source_.randomization) manifest["randomize"] = Json::parse(randomization_json(*source_.randomization));
    manifest["frames"] = frames.size();
    manifest["depth_png"] = "millimetres, 65535 for that and more, 0 where nothing is hit";
    manifest["flow"] =
        "pixels from this frame's mid-shutter to the next one's (.flo), u right, v down; the .exr has both directions";
    manifest["flow_shutter"] =
        "pixels from sharp-open to sharp-close, on the pixels of sharp-open (forward, .flo), and from sharp-close to "
        "sharp-open, on those of sharp-close (backward)";
    manifest["coc"] = "signed radius in pixels, negative in front of the focus plane";
    manifest["hash"] = "XXH3, 128 bits";
    manifest["files"] = files;
    write_shared("camera.json", {{"frames", cameras}});
    write_shared("manifest.json", manifest);
}

// Several shards may write it at once: each under a name of its own first.
void Dataset::write_shared(const char* name, const Json& json) const {
    const fs::path final_name = folder_ / name;
    if (!shard_) return write_text_file(final_name, dump(json));
    const fs::path own_name = shard_name(final_name, *shard_);
    write_text_file(own_name, dump(json));
    fs::rename(own_name, final_name);
}

}  // namespace

std::unique_ptr<FrameOutput> make_dataset_output(const FrameSource& source, const fs::path& folder,
                                                 const std::vector<std::int64_t>& frames,
                                                 const std::optional<Shard>& shard) {
    return std::make_unique<Dataset>(source, folder, frames, shard);
}

}  // namespace pentaprism::cli
