#pragma once
// What decides on the device whether a covered sample of a mask or of a blended surface is a hit: frame/opacity.glsl
// reads it. All of it needs a Device::Current.

#include "frame/opacity.h"
#include "gl/objects.h"

namespace pentaprism::gl {

class OpacityUpload {
  public:
    explicit OpacityUpload(const Frame& frame);

    /// Its three buffers, to texture units from `first` on.
    void bind(GLuint first) const;

  private:
    Buffer records_, codes_, surfaces_;
    Object<TextureKind> record_view_, code_view_, surface_view_;
};

}  // namespace pentaprism::gl
