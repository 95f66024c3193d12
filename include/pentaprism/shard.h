#pragma once
// A frame in parts: rendered by several processes or machines, and joined to the very bits of one run.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <pentaprism/image.h>
#include <pentaprism/render.h>
#include <pentaprism/settings.h>
#include <span>
#include <string>
#include <vector>

namespace pentaprism {

/// The frame's tiles of 32 x 32 pixels are dealt out in turn: part `index`, from 0, of `count`.
struct Shard {
    int index = 0, count = 1;
};
inline constexpr int kMostShards = 1'000'000;

/// Takes the bytes of a shard in order. May throw Error, which ends the frame.
class ByteSink {
  public:
    virtual ~ByteSink() = default;
    virtual void write(std::span<const std::byte> bytes) = 0;
};

/// Gives them back.
class ByteSource {
  public:
    virtual ~ByteSource() = default;
    /// What messages call it.
    virtual std::string name() const = 0;
    /// Fills `bytes`. Throws Error(kScene) if fewer are left.
    virtual void read(std::span<std::byte> bytes) = 0;
    virtual bool at_end() = 0;
};

/// A shard's file has its name only when it is whole: finish() says so.
class ShardFile : public ByteSink {
  public:
    virtual void finish() = 0;
};
std::unique_ptr<ShardFile> make_shard_file(const std::filesystem::path& file);
std::unique_ptr<ByteSource> open_shard_file(const std::filesystem::path& file);

/// How the picture was asked for, from the head of a shard's file. Throws Error(kScene) if it is none.
FileMetadata read_shard_metadata(const std::filesystem::path& file);

/// Joins all parts of a frame, given in any order. Bytes that are damaged, cut short or too many are Error(kScene), at
/// the latest before merge() returns: finish a file only after it.
class ShardMerger {
  public:
    /// Reads the heads. Throws Error(kUsage) unless the shards are all parts of one frame, each once.
    explicit ShardMerger(std::vector<std::unique_ptr<ByteSource>> sources);
    ~ShardMerger();

    const FrameInfo& info() const;
    const FileMetadata& metadata() const;
    /// What make_picture_writer() wants.
    const ImageSettings& image() const;

    /// Once.
    void merge(RowSink& sink);

  private:
    struct Part;
    std::vector<std::unique_ptr<Part>> parts_;  // by index
};

}  // namespace pentaprism
