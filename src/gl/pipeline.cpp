#include "gl/pipeline.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <pentaprism/error.h>

#include "cover/hits.h"
#include "gl/raster_pass.h"
#include "gl/tile_pass.h"

namespace pentaprism::gl {
namespace {

bool choose_compute(const Device& device, const Frame& frame, GlPipeline pipeline) {
    if (pipeline == GlPipeline::kGeometry) return false;
    if (TilePass::can_do(device, frame)) return true;
    if (pipeline == GlPipeline::kAuto) return false;
    throw Error(ErrorKind::kBackend,
                "--gl-pipeline compute: the scene is too large for this device's storage blocks; use auto");
}

Object<TextureKind> counter_image(int width, int height) {
    Object<TextureKind> image = make_texture(GL_TEXTURE_2D);
    glTextureStorage2D(image, 1, GL_R32UI, width, height);
    return image;
}

void clear_counters(GLuint image) {
    constexpr GLuint kZero = 0;
    glClearTexImage(image, 0, GL_RED_INTEGER, GL_UNSIGNED_INT, &kZero);
}

std::vector<std::uint32_t> read_counters(GLuint image, const Region& region) {
    std::vector<std::uint32_t> counts(static_cast<std::size_t>(region.width()) * region.height());
    glGetTextureSubImage(image, 0, 0, 0, 0, region.width(), region.height(), 1, GL_RED_INTEGER, GL_UNSIGNED_INT,
                         static_cast<GLsizei>(counts.size() * sizeof(std::uint32_t)), counts.data());
    return counts;
}

}  // namespace

Pipeline::Pipeline(Device& device, const Frame& frame, const SampleTable& table, const MethodSettings& method,
                   const Region& largest)
    : table_(table),
      culling_(parse_gl_culling(method.culling)),
      compute_(choose_compute(device, frame, method.gl_pipeline)),
      slots_(std::min(compute_ ? TilePass::kMostSlots : device.samples(), table.slots())),
      width_(largest.cell_columns * kCellSize),
      height_(largest.cell_rows * kCellSize),
      geometry_(frame),
      opacity_(frame),
      samples_(static_cast<std::size_t>(width_) * height_ * slots_),
      collected_(static_cast<std::size_t>(width_) * height_ * slots_ * sizeof(glm::uvec2)),
      tested_(counter_image(width_, height_)),
      covered_(counter_image(width_, height_)) {
    const PassData data{frame, table, geometry_, opacity_, samples_, collected_};
    if (compute_)
        pass_ = std::make_unique<TilePass>(device, data, culling_, width_, height_);
    else
        pass_ = std::make_unique<RasterPass>(device, data, culling_, width_, height_, slots_);
    check("making the buffers of a frame");
}

void Pipeline::receive(const Region& region, int first_slot, int count, RegionHits& hits) {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    const std::size_t blocks = static_cast<std::size_t>(region.cells()) * kBlocksPerCell;
    const std::size_t of_block = static_cast<std::size_t>(count) * kLanes;
    received_.resize(blocks * of_block);
    collected_.read(0, received_.size() * sizeof(glm::uvec2), received_.data());
    for (std::size_t block = 0; block < blocks; ++block)
        for (std::size_t i = 0; i < of_block; ++i) {
            const glm::uvec2 hit = received_[block * of_block + i];
            if (hit.x == kNoTriangle) continue;
            const std::size_t to = (block * table_.slots() + first_slot) * kLanes + i;
            hits.triangle[to] = hit.x;
            hits.depth[to] = std::bit_cast<float>(hit.y);
        }
}

RegionHits Pipeline::render(const Region& region) {
    RegionHits hits;
    const std::size_t samples = static_cast<std::size_t>(region.cells()) * kBlocksPerCell * table_.slots() * kLanes;
    hits.depth.assign(samples, std::numeric_limits<float>::infinity());
    hits.triangle.assign(samples, kNoTriangle);

    clear_counters(tested_);
    clear_counters(covered_);
    glBindImageTexture(kTestedImage, tested_, 0, GL_FALSE, 0, GL_READ_WRITE, GL_R32UI);
    glBindImageTexture(kCoveredImage, covered_, 0, GL_FALSE, 0, GL_READ_WRITE, GL_R32UI);
    for (int first = 0; first < table_.slots(); first += slots_) {
        const int count = std::min(slots_, table_.slots() - first);
        samples_.write(table_, region, first, count);
        pass_->run(region, count, first == 0);
        receive(region, first, count, hits);
    }
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    hits.tested = read_counters(tested_, region);
    hits.covered = read_counters(covered_, region);
    check("rendering");
    return hits;
}

}  // namespace pentaprism::gl
