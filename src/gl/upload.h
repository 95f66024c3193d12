#pragma once
// A frame and its samples in the memory of the device. All of it needs a Device::Current.

#include <glm/vec4.hpp>
#include <vector>

#include "frame/frame.h"
#include "gl/objects.h"
#include "gl/region.h"
#include "sample/sample_table.h"

namespace pentaprism::gl {

/// The posed points as they are, shared by all segments: a corner is read at both ends of its segment by two offsets
/// into one buffer.
class FrameUpload {
  public:
    explicit FrameUpload(const Frame& frame);

    /// Binds what draw() reads.
    void bind() const;

    /// Points, corners and depths as storage blocks from `first` on.
    void bind_storage(GLuint first) const;

    /// Draws the triangles of one motion segment of a part.
    void draw(const Part& part, int segment) const;

  private:
    Buffer points_, depths_, corners_;
    Object<VertexArrayKind> attributes_;
};

/// One sample as gl/sample_bits.glsl reads it. `index`: of the sample in its pixel.
glm::uvec4 packed_sample(const SampleVector& samples, int lane, std::uint32_t index);

/// The samples of one pass, packed as gl/samples.glsl reads them.
class SampleUpload {
  public:
    explicit SampleUpload(std::size_t most_entries);

    /// Slots [first, first + count) of every block of the region.
    void write(const SampleTable& table, const Region& region, int first, int count);

    /// To texture unit `unit`.
    void bind(GLuint unit) const { glBindTextureUnit(unit, view_); }

  private:
    Buffer buffer_;
    Object<TextureKind> view_;
    std::vector<glm::uvec4> packed_;
    std::vector<SampleVector> room_;
};

}  // namespace pentaprism::gl
