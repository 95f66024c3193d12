// What is no picture yet: `--shard I/N` of a single frame, its part of the tiles for `pentaprism merge`; and
// `--samples`.

#include <fmt/format.h>
#include <pentaprism/error.h>
#include <pentaprism/frames.h>

#include "cli/frame_output.h"
#include "cli/interrupt.h"
#include "cli/resume.h"
#include "cli/values.h"

namespace pentaprism::cli {
namespace {

namespace fs = std::filesystem;

class StreamOutput : public FrameOutput {
  public:
    /// Without a shard: samples.
    StreamOutput(const FrameSource& source, const fs::path& out, const std::optional<Shard>& shard)
        : source_(source), out_(out), shard_(shard) {}

    std::string name(std::int64_t frame) const override { return file(frame).string(); }
    bool exists(std::int64_t frame) const override { return fs::exists(file(frame)); }
    void check_resumable(std::span<const std::int64_t> frames) override {
        for (const std::int64_t frame : frames) check_made_with(file(frame), source_.metadata(source_.at(frame)));
    }
    RenderStats render(Renderer& renderer, std::int64_t frame, const Progress& progress) override {
        const auto stream = make_shard_file(file(frame));
        RenderStats stats;
        const double number = static_cast<double>(frame);
        const RenderSettings settings = source_.at(frame);
        if (shard_)
            renderer.render_shard(settings, number, *shard_, source_.metadata(settings), *stream, stats, progress);
        else
            renderer.render_samples(settings, number, source_.metadata(settings), *stream, stats, progress);
        throw_if_interrupted();
        stream->finish();
        return stats;
    }

  private:
    fs::path file(std::int64_t frame) const {
        const fs::path name = frame_file(out_, frame);
        return shard_ ? shard_name(name, *shard_) : name;
    }

    FrameSource source_;
    fs::path out_;
    std::optional<Shard> shard_;
};

}  // namespace

fs::path shard_name(const fs::path& picture, const Shard& shard) {
    return fmt::format("{}.{}-of-{}.shard", picture.string(), shard.index + 1, shard.count);
}

Shard parse_shard(const std::string& text) {
    const std::size_t slash = text.find('/');
    if (slash == std::string::npos)
        throw Error(ErrorKind::kUsage, fmt::format("--shard: '{}' is not of the form I/N, such as 2/4", text));
    Shard shard;
    shard.count = static_cast<int>(parse_whole("--shard", text.substr(slash + 1), 1, kMostShards));
    shard.index = static_cast<int>(parse_whole("--shard", text.substr(0, slash), 1, shard.count)) - 1;
    return shard;
}

std::vector<std::int64_t> frames_of(const std::vector<std::int64_t>& frames, const Shard& shard) {
    std::vector<std::int64_t> mine;
    for (std::size_t i = shard.index; i < frames.size(); i += shard.count) mine.push_back(frames[i]);
    return mine;
}

std::unique_ptr<FrameOutput> make_shard_output(const FrameSource& source, const fs::path& out, const Shard& shard) {
    return std::make_unique<StreamOutput>(source, out, shard);
}

std::unique_ptr<FrameOutput> make_samples_output(const FrameSource& source, const fs::path& out) {
    return std::make_unique<StreamOutput>(source, out, std::nullopt);
}

}  // namespace pentaprism::cli
