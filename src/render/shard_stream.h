#pragma once
// A shard or stored samples as bytes (docs/develop/shards.md): mark, length of the head, head (JSON), the tiles in
// order, hash of all that. Numbers lie as in memory, lowest byte first.

#include <pentaprism/shard.h>

#include "base/hash.h"
#include "render/visibility.h"
#include "resolve/tile_sums.h"

namespace pentaprism {

enum class StreamKind { kShard, kSamples };

/// What stands before the tiles.
struct StreamHead {
    Shard shard;
    FrameInfo info;
    ImageSettings image;  ///< samples per pixel, filter, exposure and tone curve alone
    FileMetadata metadata;
    /// What stored samples are developed by beside FrameInfo.
    struct Camera {
        bool perspective = true;
        double lens_ratio = 1.0;
        bool thin_lens = true;     ///< at rest; no artist's blur, no plane of focus that leans
        bool round = true;         ///< the aperture is a disk, everywhere in the picture
        bool even_shutter = true;  ///< neither curve nor rolling
    } camera;
};
StreamHead head_of(const Shard& shard, const FrameInfo& info, const View& view, const RenderSettings& settings,
                   const FileMetadata& metadata);

/// Those of the shard, of all tiles of a frame.
std::vector<Tile> tiles_of(std::span<const Tile> tiles, const Shard& shard);

class TileOutput {
  public:
    /// Writes the head.
    TileOutput(StreamKind kind, const StreamHead& head, ByteSink& out);
    template <class T>
    void write(const std::vector<T>& numbers) {
        write(numbers.data(), numbers.size() * sizeof(T));
    }
    /// After the last tile.
    void finish();

  private:
    void write(const void* bytes, std::size_t count);
    ByteSink& out_;
    Hash hash_;
};

class TileInput {
  public:
    /// Reads the head.
    TileInput(StreamKind kind, std::unique_ptr<ByteSource> source);
    const StreamHead& head() const { return head_; }
    std::string name() const { return source_->name(); }
    template <class T>
    void read(std::vector<T>& numbers) {
        read(numbers.data(), numbers.size() * sizeof(T));
    }
    /// After the last tile: the hash must be right and nothing more may come.
    void finish();

  private:
    void read(void* bytes, std::size_t count);
    [[noreturn]] void refuse(const std::string& why) const;
    std::unique_ptr<ByteSource> source_;
    Hash hash_;
    StreamHead head_;
};

/// A tile of a shard; `sums` to be read were started for it.
void write_sums(const TileSums& sums, TileOutput& out);
void read_sums(TileInput& in, TileSums& sums);

/// What two heads that cannot be parts of one frame differ in; empty if they can.
std::string difference(const StreamHead& a, const StreamHead& b);

}  // namespace pentaprism
