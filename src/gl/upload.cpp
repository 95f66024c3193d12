#include "gl/upload.h"

#include <bit>

namespace pentaprism::gl {
namespace {

constexpr GLuint kAtOpen = 0, kAtClose = 1, kDepthAtOpen = 2, kDepthAtClose = 3;

}  // namespace

// All of it is exact.
glm::uvec4 packed_sample(const SampleVector& samples, int lane, std::uint32_t index) {
    const auto place = [](float h) { return static_cast<std::uint32_t>((h + kCellSize / 2) * 256.0f); };
    const std::uint32_t t = static_cast<std::uint32_t>(samples.t[lane] * 0x1p24f);
    return {std::bit_cast<std::uint32_t>(samples.u[lane]), std::bit_cast<std::uint32_t>(samples.v[lane]),
            t << 8 | (index & 0xff), place(samples.x[lane]) | place(samples.y[lane]) << 14 | index >> 8 << 28};
}

FrameUpload::FrameUpload(const Frame& frame)
    : points_(frame.points.size() * sizeof(glm::vec4), frame.points.data()),
      depths_(frame.depths.size() * sizeof(float), frame.depths.data()),
      corners_(frame.corners.size() * sizeof(std::uint32_t), frame.corners.data()),
      attributes_(make_vertex_array()) {
    glVertexArrayElementBuffer(attributes_, corners_);
    for (const GLuint a : {kAtOpen, kAtClose, kDepthAtOpen, kDepthAtClose}) {
        const bool depth = a == kDepthAtOpen || a == kDepthAtClose;
        if (depth && frame.view.perspective) continue;
        glEnableVertexArrayAttrib(attributes_, a);
        glVertexArrayAttribFormat(attributes_, a, depth ? 1 : 4, GL_FLOAT, GL_FALSE, 0);
        glVertexArrayAttribBinding(attributes_, a, a);
    }
}

void FrameUpload::bind() const {
    glBindVertexArray(attributes_);
}

void FrameUpload::bind_storage(GLuint first) const {
    points_.bind(GL_SHADER_STORAGE_BUFFER, first);
    corners_.bind(GL_SHADER_STORAGE_BUFFER, first + 1);
    depths_.bind(GL_SHADER_STORAGE_BUFFER, first + 2);
}

void FrameUpload::draw(const Part& part, int segment) const {
    const auto read_at = [&](GLuint attribute, GLuint buffer, std::size_t knot, std::size_t size) {
        glVertexArrayVertexBuffer(attributes_, attribute, buffer,
                                  static_cast<GLintptr>(knot * part.vertex_count * size), static_cast<GLsizei>(size));
    };
    const std::size_t open = static_cast<std::size_t>(segment), close = open + (part.moves ? 1 : 0);
    read_at(kAtOpen, points_, open, sizeof(glm::vec4));
    read_at(kAtClose, points_, close, sizeof(glm::vec4));
    read_at(kDepthAtOpen, depths_, open, sizeof(float));
    read_at(kDepthAtClose, depths_, close, sizeof(float));
    const std::size_t first = std::size_t{part.first_triangle} * 3 * sizeof(std::uint32_t);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * part.triangle_count), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(first));
}

SampleUpload::SampleUpload(std::size_t most_entries)
    : buffer_(most_entries * sizeof(glm::uvec4)), view_(make_texture(GL_TEXTURE_BUFFER)) {
    glTextureBuffer(view_, GL_RGBA32UI, buffer_);
}

void SampleUpload::write(const SampleTable& table, const Region& region, int first, int count) {
    packed_.clear();
    for (int cy = region.cell_y; cy < region.cell_y + region.cell_rows; ++cy)
        for (int cx = region.cell_x; cx < region.cell_x + region.cell_columns; ++cx) {
            const auto vectors = table.cell(cx, cy, room_);
            for (int block = 0; block < kBlocksPerCell; ++block) {
                const auto indices =
                    table.indices(cx * kCellBlocks + block % kCellBlocks, cy * kCellBlocks + block / kCellBlocks);
                for (int slot = first; slot < first + count; ++slot) {
                    const SampleVector& samples = vectors[static_cast<std::size_t>(block) * table.slots() + slot];
                    for (int lane = 0; lane < kLanes; ++lane)
                        packed_.push_back(packed_sample(samples, lane, indices[slot * kLanes + lane]));
                }
            }
        }
    buffer_.write(0, packed_.size() * sizeof(glm::uvec4), packed_.data());
}

}  // namespace pentaprism::gl
