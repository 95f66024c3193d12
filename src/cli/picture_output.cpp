// Frames as pictures: `-o OUT`, with the sharp twin of each if asked for.

#include <pentaprism/frames.h>
#include <pentaprism/metadata.h>

#include "cli/frame_output.h"
#include "cli/progress.h"
#include "cli/resume.h"
#include "cli/tee.h"

namespace pentaprism::cli {
namespace {

namespace fs = std::filesystem;

// Remembers what the frame was, for its twin.
class RememberingTee : public Tee {
  public:
    using Tee::Tee;
    FrameInfo info;
    void begin(const FrameInfo& frame) override {
        info = frame;
        Tee::begin(frame);
    }
};

class PictureOutput : public FrameOutput {
  public:
    PictureOutput(const FrameSource& source, const fs::path& out, bool sharp)
        : source_(source), out_(out), sharp_(sharp) {}

    std::string name(std::int64_t frame) const override { return frame_file(out_, frame).string(); }
    bool exists(std::int64_t frame) const override {
        const fs::path file = frame_file(out_, frame);
        return fs::exists(file) && (!sharp_ || fs::exists(twin_of(file)));
    }
    void check_resumable(std::span<const std::int64_t> frames) override {
        for (const std::int64_t frame : frames) {
            const fs::path file = frame_file(out_, frame);
            const RenderSettings settings = source_.at(frame);
            check_made_with(file, source_.metadata(settings));
            if (sharp_) check_made_with(twin_of(file), source_.metadata(sharp_settings(settings)));
        }
    }
    RenderStats render(Renderer& renderer, std::int64_t frame, const Progress& progress) override {
        const fs::path file = frame_file(out_, frame);
        const RenderSettings settings = source_.at(frame);
        RememberingTee tee({file}, settings.image, source_.metadata(settings));
        RenderStats stats;
        const int passes = sharp_ ? 2 : 1;
        renderer.render(settings, static_cast<double>(frame), tee, stats, part_of(progress, 0, passes));
        tee.finish();
        stats.times_ms["write"] = tee.milliseconds();
        if (sharp_) {
            const RenderSettings sharp = sharp_settings(settings);
            Tee twin({twin_of(file)}, sharp.image, source_.metadata(sharp));
            RenderStats ignored;
            renderer.render(sharp, moment_of(tee.info, SharpMoment::kMiddle), twin, ignored,
                            part_of(progress, 1, passes));
            twin.finish();
        }
        return stats;
    }

  private:
    static fs::path twin_of(const fs::path& file) {
        fs::path twin = file;
        return twin.replace_extension(".sharp" + file.extension().string());
    }
    FrameSource source_;
    fs::path out_;
    bool sharp_;
};

}  // namespace

RenderSettings FrameSource::at(std::int64_t frame) const {
    return randomization ? randomized(settings, *randomization, frame) : settings;
}

FileMetadata FrameSource::metadata(const RenderSettings& of) const {
    FileMetadata metadata;
    metadata.software = software;
    metadata.settings_json = settings_json(of, scene, scene_hash, pictures);
    return metadata;
}

// A pinhole, and a shutter that is open for no time, everywhere.
RenderSettings sharp_settings(RenderSettings settings) {
    settings.image.aovs.clear();
    settings.camera.defocus = false;
    settings.shutter.shutter = 0.0;
    settings.shutter.rolling = RollingShutter::kNone;
    settings.shutter.rolling_duration.reset();
    settings.shutter.curve.clear();
    return settings;
}

double moment_of(const FrameInfo& info, SharpMoment moment) {
    const double time = moment == SharpMoment::kOpen    ? info.shutter_open
                        : moment == SharpMoment::kClose ? info.shutter_close
                                                        : 0.5 * (info.shutter_open + info.shutter_close);
    return time * info.fps;
}

std::unique_ptr<FrameOutput> make_picture_output(const FrameSource& source, const fs::path& out, bool sharp) {
    return std::make_unique<PictureOutput>(source, out, sharp);
}

}  // namespace pentaprism::cli
