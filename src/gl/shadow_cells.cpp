#include "gl/shadow_cells.h"

#include <algorithm>

#include "base/parallel.h"
#include "sample/net.h"

namespace pentaprism::gl {
namespace {

// As shade/shadow_map.glsl has them.
constexpr int kFinest = -24;
constexpr std::uint32_t kMostRequests = 1 << 14, kMarks = 4096;
constexpr std::size_t kHeadBytes = (2 + kMarks) * sizeof(std::uint32_t);

constexpr std::size_t kCellBytes = ShadowSamples::kPerCell * sizeof(float);
constexpr std::size_t kFirstRoom = 256, kMostRoom = 16384;  // cells: 4 MB, 256 MB
constexpr std::size_t kFirstTable = 1 << 12;

}  // namespace

ShadowCells::ShadowCells(const Device& device, const std::vector<const ShadowMap*>& maps)
    : maps_(maps),
      most_cells_(std::min<std::size_t>(
          kMostRoom,
          static_cast<std::size_t>(std::min(device.most_texels() / ShadowSamples::kPerCell,
                                            device.most_block_bytes() / static_cast<std::int64_t>(kCellBytes))))),
      requests_(kHeadBytes + kMostRequests * sizeof(glm::uvec2)) {
    make_room(std::min(kFirstRoom, most_cells_));
    forget();
}

void ShadowCells::forget() {
    used_ = entries_ = 0;
    table_.assign(kFirstTable, glm::uvec4(0));
}

// Keeps what is there.
void ShadowCells::make_room(std::size_t cells) {
    if (cells <= room_) return;
    std::size_t wanted = std::max(room_, kFirstRoom);
    while (wanted < cells) wanted *= 2;
    wanted = std::min(wanted, most_cells_);
    Buffer larger(wanted * kCellBytes);
    if (used_ > 0) glCopyNamedBufferSubData(depths_, larger, 0, 0, static_cast<GLsizeiptr>(used_ * kCellBytes));
    depths_ = std::move(larger);
    depths_view_ = view_of(depths_, GL_R32F);
    room_ = wanted;
}

void ShadowCells::place(const glm::uvec4& entry) {
    const std::size_t mask = table_.size() - 1;
    std::size_t at = mix(entry.x ^ mix(entry.y)) & mask;
    while (table_[at].z != 0) at = (at + 1) & mask;
    table_[at] = entry;
}

// At most half full, so that a search always ends at an empty entry.
void ShadowCells::insert(const glm::uvec2& key, std::uint32_t cell, bool empty) {
    if (2 * (++entries_) > table_.size()) {
        const std::vector<glm::uvec4> old = std::move(table_);
        table_.assign(2 * old.size(), glm::uvec4(0));
        for (const glm::uvec4& entry : old)
            if (entry.z != 0) place(entry);
    }
    place({key.x, key.y, cell + 1, empty ? 1 : 0});
}

void ShadowCells::bind(const Program& program) {
    if (table_on_device_ != table_.size()) pages_ = Buffer(table_.size() * sizeof(glm::uvec4));
    table_on_device_ = table_.size();
    pages_.write(0, table_.size() * sizeof(glm::uvec4), table_.data());
    const std::vector<std::uint32_t> nothing(kHeadBytes / sizeof(std::uint32_t));
    requests_.write(0, kHeadBytes, nothing.data());
    program.set("page_mask", static_cast<unsigned>(table_.size() - 1));
    program.set("most_requests", kMostRequests);
    pages_.bind(GL_SHADER_STORAGE_BUFFER, 4);
    requests_.bind(GL_SHADER_STORAGE_BUFFER, 6);
    glBindTextureUnit(12, depths_view_);
}

// In parallel, with the context held by this thread alone.
void ShadowCells::draw(std::vector<Drawn>& cells) const {
    isolated([&] {
        parallel_for(cells.size(), [&](std::size_t i) {
            const glm::uvec2 key = cells[i].key;
            const int exponent = static_cast<int>(key.y >> 8 & 0xff) + kFinest, limit = static_cast<int>(key.y & 0xff);
            cells[i].depths = maps_[key.y >> 16]->depths(exponent, limit, static_cast<int>(key.x & 0xffff),
                                                         static_cast<int>(key.x >> 16));
        });
    });
}

std::uint32_t ShadowCells::receive() {
    was_full_ = false;
    std::uint32_t head[2];
    requests_.read(0, sizeof head, head);
    if (head[1] == 0) return 0;
    std::vector<glm::uvec2> keys(std::min(head[0], kMostRequests));
    requests_.read(kHeadBytes, keys.size() * sizeof(glm::uvec2), keys.data());
    const auto before = [](const glm::uvec2& a, const glm::uvec2& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; };
    std::sort(keys.begin(), keys.end(), before);
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    const ShadowCellStore::Visit visit(maps_.front()->store());
    std::vector<Drawn> cells;
    for (const glm::uvec2& key : keys) cells.push_back({key, nullptr});
    draw(cells);
    const std::size_t wanted =
        used_ + static_cast<std::size_t>(std::count_if(
                    cells.begin(), cells.end(), [](const Drawn& cell) { return !ShadowMap::is_empty(cell.depths); }));
    if (wanted > most_cells_) {
        forget();
        was_full_ = true;
        return head[1];
    }
    make_room(wanted);
    for (const Drawn& cell : cells) {
        const bool empty = ShadowMap::is_empty(cell.depths);
        insert(cell.key, static_cast<std::uint32_t>(used_), empty);
        if (!empty) depths_.write(used_++ * kCellBytes, kCellBytes, cell.depths);
    }
    return head[1];
}

}  // namespace pentaprism::gl
