// One frame by several MPI processes: each renders a shard, the first one joins them and writes.

#include <algorithm>
#include <pentaprism/error.h>
#include <pentaprism/frames.h>

#include "cli/frame_output.h"
#include "cli/interrupt.h"
#include "cli/ranks.h"
#include "cli/resume.h"

namespace pentaprism::cli {
namespace {

namespace fs = std::filesystem;

struct MemorySink : ByteSink {
    std::vector<std::byte> bytes;
    void write(std::span<const std::byte> more) override { bytes.insert(bytes.end(), more.begin(), more.end()); }
};

class MemorySource : public ByteSource {
  public:
    explicit MemorySource(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}
    std::string name() const override { return "rank 0"; }
    bool at_end() override { return at_ == bytes_.size(); }
    void read(std::span<std::byte> out) override {
        if (out.size() > bytes_.size() - at_)
            throw Error(ErrorKind::kScene, name() + ": cannot read (it ends too early)");
        std::copy_n(bytes_.begin() + at_, out.size(), out.begin());
        at_ += out.size();
    }

  private:
    std::vector<std::byte> bytes_;
    std::size_t at_ = 0;
};

class RanksOutput : public FrameOutput {
  public:
    RanksOutput(const FrameSource& source, const fs::path& out, const Ranks& ranks)
        : source_(source), out_(out), ranks_(ranks) {}

    std::string name(std::int64_t frame) const override { return frame_file(out_, frame).string(); }
    bool exists(std::int64_t frame) const override { return first_decides(fs::exists(frame_file(out_, frame))); }
    void check_resumable(std::span<const std::int64_t> frames) override {
        if (!ranks_.first()) return;
        for (const std::int64_t frame : frames)
            check_made_with(frame_file(out_, frame), source_.metadata(source_.at(frame)));
    }
    RenderStats render(Renderer& renderer, std::int64_t frame, const Progress& progress) override {
        const RenderSettings settings = source_.at(frame);
        MemorySink mine;
        RenderStats stats;
        renderer.render_shard(settings, static_cast<double>(frame), {ranks_.rank, ranks_.size},
                              source_.metadata(settings), mine, stats, progress);
        throw_if_interrupted();
        if (ranks_.first())
            join(std::move(mine.bytes), frame_file(out_, frame));
        else
            send_to_first(mine.bytes);
        return stats;
    }

  private:
    void join(std::vector<std::byte> mine, const fs::path& file) const {
        std::vector<std::unique_ptr<ByteSource>> sources;
        sources.push_back(std::make_unique<MemorySource>(std::move(mine)));
        for (int rank = 1; rank < ranks_.size; ++rank) sources.push_back(bytes_from(rank));
        ShardMerger merger(std::move(sources));
        const auto writer = make_picture_writer(file, merger.image(), merger.metadata());
        merger.merge(*writer);
        throw_if_interrupted();
        writer->finish();
    }

    FrameSource source_;
    fs::path out_;
    Ranks ranks_;
};

}  // namespace

std::unique_ptr<FrameOutput> make_ranks_output(const FrameSource& source, const fs::path& out, const Ranks& ranks) {
    return std::make_unique<RanksOutput>(source, out, ranks);
}

}  // namespace pentaprism::cli
