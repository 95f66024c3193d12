#include "gl/shading.h"

#include <algorithm>

#include "cover/hits.h"
#include "shade/tile_shade.h"

namespace pentaprism::gl {
namespace {

constexpr GLenum kStorage = GL_SHADER_STORAGE_BUFFER;
constexpr std::size_t kMostSamples = 1 << 18, kMostShares = 1 << 18;  // at once
constexpr std::size_t kPointBytes = 64, kShareBytes = 32, kLaneBytes = 16 * sizeof(glm::vec2);
constexpr int kQuarters = 4;

const Program& program_of(Device& device, const char* path) {
    return device.program(path, [&] { return Program({{GL_COMPUTE_SHADER, path}}, device.defines()); });
}

void dispatch(std::size_t items) {
    constexpr std::size_t kGroup = 64, kRow = 32768;  // items of a group, groups of a row
    const std::size_t groups = (items + kGroup - 1) / kGroup, rows = (groups + kRow - 1) / kRow;
    if (groups == 0) return;
    glDispatchCompute(static_cast<GLuint>(std::min(groups, kRow)), static_cast<GLuint>(rows), 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

}  // namespace

Shading::Shading(Device& device, const ShadingScene& scene, const SampleTable& table)
    : scene_(scene),
      table_(table),
      gather_(program_of(device, "gl/shade_gather.comp.glsl")),
      points_(program_of(device, "gl/shade_points.comp.glsl")),
      shadows_(program_of(device, "gl/shade_shadows.comp.glsl")),
      finish_(program_of(device, "gl/shade_finish.comp.glsl")),
      upload_(device, scene),
      cells_(device, upload_.maps()) {
    const std::size_t of_block = static_cast<std::size_t>(table.slots()) * kLanes;
    const std::size_t fit = static_cast<std::size_t>(device.most_block_bytes()) / kLaneBytes;  // the largest buffer
    most_blocks_ = std::max<std::size_t>(1, std::min(kMostSamples, fit) / of_block);
    const std::size_t samples = most_blocks_ * of_block;  // and as many points at most
    const std::size_t casting = static_cast<std::size_t>(upload_.casting_lights());
    most_points_ = std::max<std::size_t>(1, std::min(samples, kMostShares / std::max<std::size_t>(1, casting)));
    check_room(static_cast<std::int64_t>(samples * kLaneBytes), device.most_block_bytes(), "a pixel's samples");
    samples_ = Buffer(samples * sizeof(glm::uvec4));
    seen_ = Buffer(samples * sizeof(std::uint32_t));
    color_of_sample_ = Buffer(samples * sizeof(std::uint32_t));
    counter_ = Buffer(sizeof(std::uint32_t));
    shade_points_ = Buffer(samples * kPointBytes);
    lanes_ = Buffer(casting > 0 ? samples * kLaneBytes : 0);
    shares_ = Buffer(most_points_ * casting * kShareBytes);
    colors_ = Buffer(samples * kQuarters * sizeof(glm::vec4));
    check("making the buffers of shading");
}

// Samples in the order of their indices, pixel by pixel: that of every sum over samples.
void Shading::send(const Region& region, const RegionHits& hits, const Batch& batch) {
    const std::size_t slots = static_cast<std::size_t>(table_.slots()), of_block = slots * kLanes;
    packed_.resize(batch.blocks * of_block);
    numbers_.resize(packed_.size());
    std::vector<SampleVector> room;
    for (std::size_t i = 0; i < batch.blocks; ++i) {
        const int block = static_cast<int>(batch.first_block + i), cell = block / kBlocksPerCell,
                  in_cell = block % kBlocksPerCell;
        const int bx = (region.cell_x + cell % region.cell_columns) * kCellBlocks + in_cell % kCellBlocks;
        const int by = (region.cell_y + cell / region.cell_columns) * kCellBlocks + in_cell / kCellBlocks;
        const std::span<const SampleVector> vectors = table_.block(bx, by, room);
        const std::span<const std::uint16_t> indices = table_.indices(bx, by);
        const std::uint32_t* triangles = &hits.triangle[static_cast<std::size_t>(block) * of_block];
        for (std::size_t slot = 0; slot < slots; ++slot)
            for (int lane = 0; lane < kLanes; ++lane) {
                const std::size_t at = slot * kLanes + lane, to = i * of_block + lane * slots + indices[at];
                packed_[to] = packed_sample(vectors[slot], lane, indices[at]);
                numbers_[to] = triangles[at];
            }
    }
    samples_.write(0, packed_.size() * sizeof(glm::uvec4), packed_.data());
    seen_.write(0, numbers_.size() * sizeof(std::uint32_t), numbers_.data());
}

std::uint32_t Shading::gather(const Region& region, const Batch& batch) {
    std::uint32_t points = 0;
    counter_.write(0, sizeof points, &points);
    gather_.use();
    gather_.set("sample_count", static_cast<unsigned>(numbers_.size()));
    gather_.set("samples_of_pixel", static_cast<unsigned>(table_.slots()));
    gather_.set("region_cell", region.cell_x, region.cell_y);
    gather_.set("region_cell_columns", region.cell_columns);
    gather_.set("first_block", static_cast<unsigned>(batch.first_block));
    upload_.bind_gather();
    shade_points_.bind(kStorage, 0);
    lanes_.bind(kStorage, 1);
    samples_.bind(kStorage, 3);
    seen_.bind(kStorage, 4);
    color_of_sample_.bind(kStorage, 5);
    counter_.bind(kStorage, 6);
    dispatch(numbers_.size());
    counter_.read(0, sizeof points, &points);
    return points;
}

void Shading::shade_points(std::uint32_t points) {
    const auto most = static_cast<std::uint32_t>(most_points_);
    for (std::uint32_t first = 0; first < points; first += most) {
        const std::uint32_t count = std::min(most, points - first);
        for (const Program* program : {&points_, &shadows_, &finish_}) {
            program->set("first_point", first);
            program->set("point_count", count);
        }
        points_.use();
        upload_.bind_points();
        shade_points_.bind(kStorage, 0);
        shares_.bind(kStorage, 7);
        dispatch(count);
        if (upload_.casting_lights() > 0)
            look_up_shadows(0, count * static_cast<std::uint32_t>(upload_.casting_lights()));
        finish_.use();
        shade_points_.bind(kStorage, 0);
        colors_.bind(kStorage, 1);
        shares_.bind(kStorage, 7);
        dispatch(count);
    }
}

// Of shares [first, first + count) of the points at hand. Those that wait ask again, until none does.
void Shading::look_up_shadows(std::uint32_t first, std::uint32_t count) {
    for (;;) {
        shadows_.use();
        shadows_.set("first_share", first);
        shadows_.set("share_count", count);
        upload_.bind_shadows();
        shade_points_.bind(kStorage, 0);
        lanes_.bind(kStorage, 1);
        shares_.bind(kStorage, 7);
        cells_.bind(shadows_);
        dispatch(count);
        if (cells_.receive() == 0) return;
        if (!cells_.was_full()) continue;
        check_room(2, count, "what a shadow is made of");
        look_up_shadows(first, count / 2);
        return look_up_shadows(first + count / 2, count - count / 2);
    }
}

void Shading::receive(const Region& region, const Batch& batch, std::uint32_t points, RegionShade& out) {
    const std::uint32_t base = static_cast<std::uint32_t>(out.colors.size());
    out.colors.resize(base + std::size_t{kQuarters} * points);
    colors_.read(0, std::size_t{kQuarters} * points * sizeof(glm::vec4), out.colors.data() + base);
    color_of_sample_.read(0, numbers_.size() * sizeof(std::uint32_t), numbers_.data());
    const std::size_t slots = static_cast<std::size_t>(table_.slots()), of_block = slots * kLanes;
    for (std::size_t i = 0; i < batch.blocks; ++i) {
        const int block = static_cast<int>(batch.first_block + i), cell = block / kBlocksPerCell,
                  in_cell = block % kBlocksPerCell;
        const std::span<const std::uint16_t> indices =
            table_.indices((region.cell_x + cell % region.cell_columns) * kCellBlocks + in_cell % kCellBlocks,
                           (region.cell_y + cell / region.cell_columns) * kCellBlocks + in_cell / kCellBlocks);
        std::uint32_t* to = &out.color_of_sample[static_cast<std::size_t>(block) * of_block];
        for (std::size_t at = 0; at < of_block; ++at) {
            const std::uint32_t from = numbers_[i * of_block + at % kLanes * slots + indices[at]];
            to[at] = from == kBackground ? kBackground : base + from;
        }
    }
}

RegionShade Shading::shade(const Region& region, const RegionHits& hits) {
    for (const Program* program : {&gather_, &points_, &shadows_, &finish_}) upload_.set_uniforms(*program, scene_);
    RegionShade out;
    out.color_of_sample.resize(hits.triangle.size());
    const std::size_t blocks = static_cast<std::size_t>(region.cells()) * kBlocksPerCell;
    for (std::size_t first = 0; first < blocks; first += most_blocks_) {
        const Batch batch{first, std::min(most_blocks_, blocks - first)};
        send(region, hits, batch);
        const std::uint32_t points = gather(region, batch);
        shade_points(points);
        receive(region, batch, points, out);
    }
    check("shading");
    return out;
}

}  // namespace pentaprism::gl
