#pragma once
// A shard as bytes (docs/develop/shards.md): mark, length of the head, head (JSON), the sums of its tiles in order,
// hash of all that. Numbers lie as in memory, lowest byte first.

#include <pentaprism/shard.h>

#include "base/hash.h"
#include "render/visibility.h"
#include "resolve/tile_sums.h"

namespace pentaprism {

/// What stands before the tiles.
struct ShardHead {
    Shard shard;
    FrameInfo info;
    ImageSettings image;  ///< filter, exposure and tone curve alone
    FileMetadata metadata;
};

/// Those of the shard, of all tiles of a frame.
std::vector<Tile> tiles_of(std::span<const Tile> tiles, const Shard& shard);

class ShardOutput {
  public:
    ShardOutput(const Shard& shard, const FrameInfo& info, const RenderSettings& settings, const FileMetadata& metadata,
                ByteSink& out);
    void write(const TileSums& tile);
    /// After the last tile.
    void finish();

  private:
    void write(const void* bytes, std::size_t count);
    ByteSink& out_;
    Hash hash_;
};

class ShardInput {
  public:
    /// Reads the head.
    explicit ShardInput(std::unique_ptr<ByteSource> source);
    const ShardHead& head() const { return head_; }
    std::string name() const { return source_->name(); }
    /// Fills `sums`, which were started for the next tile.
    void read(TileSums& sums);
    /// After the last tile: the hash must be right and nothing more may come.
    void finish();

  private:
    void read(void* bytes, std::size_t count);
    [[noreturn]] void refuse(const std::string& why) const;
    std::unique_ptr<ByteSource> source_;
    Hash hash_;
    ShardHead head_;
};

/// What two heads that cannot be parts of one frame differ in; empty if they can.
std::string difference(const ShardHead& a, const ShardHead& b);

}  // namespace pentaprism
