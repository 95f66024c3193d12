#include <cerrno>
#include <cstdio>
#include <fmt/format.h>
#include <pentaprism/error.h>
#include <pentaprism/shard.h>
#include <system_error>

#include "image/part_file.h"

namespace pentaprism {
namespace {

class PartShardFile : public ShardFile {
  public:
    explicit PartShardFile(const std::filesystem::path& file) : part_(file) {}
    void write(std::span<const std::byte> bytes) override { part_.write(bytes.data(), bytes.size()); }
    void finish() override { part_.commit(); }

  private:
    PartFile part_;
};

class FileSource : public ByteSource {
  public:
    explicit FileSource(const std::filesystem::path& file) : file_(file), stream_(std::fopen(file.c_str(), "rbe")) {
        if (!stream_) fail(std::generic_category().message(errno));
    }
    std::string name() const override { return file_.string(); }
    void read(std::span<std::byte> bytes) override {
        if (std::fread(bytes.data(), 1, bytes.size(), stream_.get()) == bytes.size()) return;
        fail(std::ferror(stream_.get()) ? std::generic_category().message(errno) : "it ends too early");
    }
    bool at_end() override {
        const int next = std::fgetc(stream_.get());
        if (next != EOF) std::ungetc(next, stream_.get());
        return next == EOF;
    }

  private:
    [[noreturn]] void fail(const std::string& why) const {
        throw Error(ErrorKind::kScene, fmt::format("{}: cannot read ({})", file_.string(), why));
    }
    struct Close {
        void operator()(std::FILE* stream) const { std::fclose(stream); }
    };
    std::filesystem::path file_;
    std::unique_ptr<std::FILE, Close> stream_;
};

}  // namespace

std::unique_ptr<ShardFile> make_shard_file(const std::filesystem::path& file) {
    return std::make_unique<PartShardFile>(file);
}

std::unique_ptr<ByteSource> open_shard_file(const std::filesystem::path& file) {
    return std::make_unique<FileSource>(file);
}

}  // namespace pentaprism
