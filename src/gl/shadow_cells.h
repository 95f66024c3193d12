#pragma once
// The cells of shadow maps that are in the memory of the device: as pages of a virtual texture, found by a hash table.
// Look-ups ask for what is missing, the processor draws it (shade/shadow_map.h). All of it needs a Device::Current.

#include <glm/vec4.hpp>
#include <vector>

#include "gl/shading_upload.h"

namespace pentaprism::gl {

class ShadowCells {
  public:
    ShadowCells(const Device& device, const std::vector<const ShadowMap*>& maps);

    /// Before a dispatch of gl/shade_shadows.comp.glsl: nothing is asked for.
    void bind(const Program& program);

    /// After it: draws what was asked for. How many shares wait for it.
    std::uint32_t receive();

    /// Whether what was asked for was more than there is room for: then all cells are gone, and fewer shares must ask.
    bool was_full() const { return was_full_; }

  private:
    struct Drawn {
        glm::uvec2 key;
        const float* depths;
    };
    void draw(std::vector<Drawn>& cells) const;
    void insert(const glm::uvec2& key, std::uint32_t cell, bool empty);
    void place(const glm::uvec4& entry);
    void make_room(std::size_t cells);
    void forget();

    const std::vector<const ShadowMap*>& maps_;
    std::size_t most_cells_, room_ = 0, used_ = 0, entries_ = 0;
    bool was_full_ = false;
    Buffer depths_, pages_, requests_;
    Object<TextureKind> depths_view_;
    std::vector<glm::uvec4> table_;  // as the shader reads it
    std::size_t table_on_device_ = 0;
};

}  // namespace pentaprism::gl
