#pragma once
// What the shading shaders look up of a frame, in the memory of the device: geometry at mid-shutter, materials,
// textures, lights, surroundings, and what casts and receives shadows. Shadow maps themselves: gl/shadow_cells.h. All
// of it needs a Device::Current.

#include <string>
#include <vector>

#include "gl/device.h"
#include "gl/objects.h"
#include "shade/shading_scene.h"

namespace pentaprism::gl {

/// A buffer that shaders read as a texture.
class TexelBuffer {
  public:
    TexelBuffer() = default;
    TexelBuffer(std::size_t bytes, const void* data, GLenum format)
        : buffer_(bytes, data), view_(view_of(buffer_, format)) {}
    void bind(GLuint unit) const { glBindTextureUnit(unit, view_); }

  private:
    Buffer buffer_;
    Object<TextureKind> view_;
};

class ShadingUpload {
  public:
    /// Throws Error(kBackend) if something does not fit the device.
    ShadingUpload(const Device& device, const ShadingScene& scene);

    /// The uniforms that all shading programs may ask for.
    void set_uniforms(const Program& program, const ShadingScene& scene) const;

    // What the passes read (gl/shade_*.comp.glsl).
    void bind_gather() const;
    void bind_points() const;
    void bind_shadows() const;

    /// Lights that cast shadows, and the maps that the shaders know by their numbers.
    int casting_lights() const { return casting_; }
    const std::vector<const ShadowMap*>& maps() const { return maps_; }

  private:
    void put_frame(const Device& device, const ShadingScene& scene);
    void put_materials(const Device& device, const ShadingScene& scene);
    void put_lights(const ShadingScene& scene);
    void put_tables(const ShadingScene& scene, const std::vector<float>& values);
    void put_shadows(const Device& device, const ShadingScene& scene);

    Buffer parts_, materials_, pyramids_, lights_, tables_, faces_, world_parts_;
    TexelBuffer points_, corners_, part_of_, attributes_, source_vertices_, pieces_, texels_, sky_;
    TexelBuffer world_points_, world_corners_, map_samples_;
    std::vector<const ShadowMap*> maps_;
    int casting_ = 0;
};

/// Throws Error(kBackend): `what` needs more elements, or bytes, than the device has room for in one buffer.
void check_room(std::int64_t needed, std::int64_t most, const std::string& what);

}  // namespace pentaprism::gl
