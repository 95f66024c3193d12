#include "gl/tile_pass.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "cover/hits.h"

namespace pentaprism::gl {
namespace {

constexpr GLuint kPointsBlock = 1, kDrawsBlock = 4, kRecordsBlock = 5, kCountsBlock = 6, kEntriesBlock = 7;
constexpr int kTile = 8, kCellTiles = kCellSize / kTile;
constexpr std::uint32_t kGroup = 64;  // invocations of the shaders that sort, and of a tile
// Pairs of triangle and sample that an invocation is asked at once: longer lists take several dispatches. Drivers stop
// what takes long: on a card a watchdog, and Mesa's llvmpipe leaves a shader's loops, all taken together, after 65535
// turns, without an error. No pair has more than 126: those of the culling test "hull" are about 70.
constexpr std::uint32_t kMostPairs = 512;
static_assert(kMostPairs >= kGroup * TilePass::kMostSlots);
// What is sorted at once, 64 MB of each: more triangles take several batches, longer lists several ranges of tiles. A
// tile has each record once at most, so that a list of its own always fits.
constexpr std::uint32_t kMostRecords = 1 << 22, kMostEntries = 1 << 24;

const Program& sorting_program(Device& device, const char* path) {
    return device.program(path, [&] { return Program({{GL_COMPUTE_SHADER, path}}, device.defines()); });
}

const Program& cover_program(Device& device, const Culling& culling) {
    const std::string shader = culling_shader(culling);
    return device.program("tiles " + shader, [&] {
        const ShaderSource extra[] = {{"culling", shader}};
        return Program({{GL_COMPUTE_SHADER, "gl/tile_cover.comp.glsl"}}, device.defines(), extra);
    });
}

std::uint32_t room_for(const Device& device, std::int64_t bytes_each, std::uint32_t most) {
    return static_cast<std::uint32_t>(std::min<std::int64_t>(most, device.most_block_bytes() / bytes_each));
}

// Those of TilePass::plan_draws(), unless a part is taken in pieces, which makes one more for each batch.
std::size_t count_draws(const Frame& frame) {
    std::size_t draws = 0;
    for (const Part& part : frame.parts) draws += part.moves ? static_cast<std::size_t>(part.segments) : 1;
    return draws;
}

void dispatch(std::uint32_t items) {
    constexpr std::uint32_t kMostGroups = 65535;
    const std::uint32_t groups = (items + kGroup - 1) / kGroup, columns = std::min(groups, kMostGroups);
    if (groups > 0) glDispatchCompute(columns, (groups + columns - 1) / columns, 1);
}

}  // namespace

bool TilePass::can_do(const Device& device, const Frame& frame) {
    const auto fits = [&](std::size_t bytes) { return static_cast<std::int64_t>(bytes) <= device.most_block_bytes(); };
    return fits(frame.points.size() * sizeof(glm::vec4)) && fits(frame.corners.size() * sizeof(std::uint32_t)) &&
           fits(frame.depths.size() * sizeof(float)) && fits(count_draws(frame) * sizeof(Draw));
}

TilePass::TilePass(Device& device, const PassData& data, const Culling& culling, int width, int height)
    : data_(data),
      bound_(sorting_program(device, "gl/tile_bound.comp.glsl")),
      fill_(sorting_program(device, "gl/tile_fill.comp.glsl")),
      cover_(cover_program(device, culling)),
      most_records_(room_for(device, sizeof(glm::uvec4), kMostRecords)),
      most_entries_(room_for(device, sizeof(std::uint32_t), kMostEntries)) {
    plan_draws();
    std::uint32_t most_items = 0;
    for (const Batch& batch : batches_) most_items = std::max(most_items, batch.items);
    draw_buffer_ = Buffer(draws_.size() * sizeof(Draw), draws_.data());
    records_ = Buffer(most_items * sizeof(glm::uvec4));
    counts_ = Buffer((static_cast<std::size_t>(width / kTile) * (height / kTile) + 1) * sizeof(std::uint32_t));
}

// As many draws in a batch as there is room for records of all their triangles; a larger part is taken in pieces.
void TilePass::plan_draws() {
    for (std::size_t p = 0; p < data_.frame.parts.size(); ++p) {
        const Part& part = data_.frame.parts[p];
        const std::uint32_t segments = part.moves ? static_cast<std::uint32_t>(part.segments) : 1;
        for (std::uint32_t segment = 0; segment < segments; ++segment) {
            const std::uint32_t open = segment * part.vertex_count,
                                close = part.moves ? open + part.vertex_count : open;
            for (std::uint32_t done = 0; done < part.triangle_count;) {
                if (batches_.empty() || batches_.back().items == most_records_)
                    batches_.push_back({draws_.size(), 0, 0});
                Batch& batch = batches_.back();
                const std::uint32_t count = std::min(part.triangle_count - done, most_records_ - batch.items);
                draws_.push_back({batch.items, part.first_triangle + done, part.first_triangle,
                                  static_cast<std::uint32_t>(p), open, close, part.two_sided ? 1u : 0u, segment,
                                  segments});
                ++batch.draws;
                batch.items += count;
                done += count;
            }
        }
    }
}

void TilePass::set_tiles(const Program& program, const Region& region) const {
    program.set("first_tile", region.cell_x * kCellTiles, region.cell_y * kCellTiles);
    program.set("tiles", region.cell_columns * kCellTiles, region.cell_rows * kCellTiles);
    program.set("with_depths", data_.frame.view.perspective ? 0 : 1);
}

void TilePass::bin(const Batch& batch, const Region& region) {
    const std::size_t tiles = static_cast<std::size_t>(region.cells()) * kCellTiles * kCellTiles;
    std::vector<std::uint32_t> counts(tiles + 1, 0);
    counts_.write(0, counts.size() * sizeof counts[0], counts.data());
    bound_.set("items", batch.items);
    bound_.set("first_draw", static_cast<std::uint32_t>(batch.first_draw));
    bound_.set("draw_count", static_cast<std::uint32_t>(batch.draws));
    bound_.use();
    dispatch(batch.items);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    counts_.read(0, counts.size() * sizeof counts[0], counts.data());
    record_count_ = counts.back();
    counts.pop_back();
    ranges_.clear();
    offsets_.resize(tiles);
    for (std::size_t t = 0; t < tiles; ++t) {
        const int tile = static_cast<int>(t);
        if (ranges_.empty() || counts[t] > most_entries_ - ranges_.back().entries)
            ranges_.push_back({tile, tile, 0, 0});
        TileRange& range = ranges_.back();
        offsets_[t] = range.entries;
        range.entries += counts[t];
        range.longest = std::max(range.longest, counts[t]);
        range.to = tile + 1;
    }
    lengths_ = std::move(counts);
}

void TilePass::fill(const TileRange& range) {
    if (range.entries > entry_room_) {
        entry_room_ = std::min(most_entries_, range.entries + range.entries / 4);
        entries_ = Buffer(std::size_t{entry_room_} * sizeof(std::uint32_t));
    }
    entries_.bind(GL_SHADER_STORAGE_BUFFER, kEntriesBlock);
    counts_.write(0, offsets_.size() * sizeof offsets_[0], offsets_.data());
    fill_.set("record_count", record_count_);
    fill_.set("some_tiles", range.from, range.to);
    fill_.use();
    dispatch(record_count_);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

// A rectangle of tiles that has them all.
PixelRect TilePass::tiles_longer_than(std::uint32_t length, const TileRange& range, int columns) const {
    PixelRect r{columns, 0, std::numeric_limits<int>::max(), 0};
    for (int tile = range.from; tile < range.to; ++tile) {
        if (lengths_[tile] <= length) continue;
        const int x = tile % columns, y = tile / columns;
        r = {std::min(r.x0, x), std::max(r.x1, x + 1), std::min(r.y0, y), std::max(r.y1, y + 1)};
    }
    return r;
}

void TilePass::cover(const TileRange& range, const Region& region, int count) {
    const std::uint32_t step = kMostPairs / static_cast<std::uint32_t>(count) / kGroup * kGroup;
    cover_.set("some_tiles", range.from, range.to);
    cover_.use();
    for (std::uint32_t done = 0; done < range.longest; done += step) {
        const PixelRect r = tiles_longer_than(done, range, region.cell_columns * kCellTiles);
        cover_.set("some_entries", done, done + step);
        cover_.set("first_group", r.x0, r.y0);
        glDispatchCompute(r.x1 - r.x0, r.y1 - r.y0, 1);
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    }
}

void TilePass::run(const Region& region, int count, bool is_first) {
    const std::uint32_t nothing[2] = {kNoTriangle,
                                      std::bit_cast<std::uint32_t>(std::numeric_limits<float>::infinity())};
    glClearNamedBufferData(data_.hits, GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, nothing);
    for (const Program* program : {&bound_, &fill_, &cover_}) {
        set_uniforms(*program, data_, region, count);
        set_tiles(*program, region);
    }
    data_.samples.bind(kSampleUnit);
    data_.opacity.bind(kOpacityUnits);
    data_.geometry.bind_storage(kPointsBlock);
    data_.hits.bind(GL_SHADER_STORAGE_BUFFER, kHitsBlock);
    records_.bind(GL_SHADER_STORAGE_BUFFER, kRecordsBlock);
    counts_.bind(GL_SHADER_STORAGE_BUFFER, kCountsBlock);
    draw_buffer_.bind(GL_SHADER_STORAGE_BUFFER, kDrawsBlock);
    for (const Batch& batch : batches_) {
        if (is_first || batches_.size() > 1) bin(batch, region);
        for (const TileRange& range : ranges_) {
            if (is_first || batches_.size() > 1 || ranges_.size() > 1) fill(range);
            entries_.bind(GL_SHADER_STORAGE_BUFFER, kEntriesBlock);
            cover(range, region, count);
        }
    }
}

}  // namespace pentaprism::gl
