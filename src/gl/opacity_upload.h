#pragma once
// What decides on the device whether a covered sample of a mask or of a blended surface is a hit: frame/opacity.glsl
// reads it. All of it needs a Device::Current.

#include <vector>

#include "frame/opacity.h"
#include "gl/program.h"

namespace pentaprism::gl {

class OpacityUpload {
  public:
    /// Throws Error(kBackend) for glass, by the name of its material.
    explicit OpacityUpload(const Frame& frame);

    /// The two buffers, to texture units `first` and `first` + 1.
    void bind(GLuint first) const;

    /// The uniforms of a part.
    void set(const Program& program, std::size_t part) const;

  private:
    struct Surface {
        AlphaMode mode = AlphaMode::kOpaque;
        OpacityTerms terms;  ///< of the part's first triangle: all but uv and colours are the part's
        int first_record = 0, first_code = 0;
    };

    std::vector<Surface> surfaces_;  // of each part
    Buffer records_, codes_;
    Object<TextureKind> record_view_, code_view_;
};

}  // namespace pentaprism::gl
