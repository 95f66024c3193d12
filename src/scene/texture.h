#pragma once
// Images as they are looked up: mip pyramids of 8-bit texels, decoded on the way out.
//
// Levels are averaged in linear light (never encoded bytes) with a box whose weights are exact for odd sizes, and
// stored as 8 bits again: half the memory of half floats, and faster where memory is what a look-up waits for.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <pentaprism/scene.h>
#include <span>
#include <vector>

#include "scene/opacity_class.h"

namespace pentaprism {

enum class Encoding : std::uint8_t { kSrgb, kLinear };

/// One image in all its sizes.
class Pyramid {
  public:
    /// `weight_by_alpha`: texels count in coarser levels by their opacity, so that the colour under fully transparent
    /// texels (often black) does not bleed into leaves' edges. An image with a size that is not positive gives one
    /// white texel.
    Pyramid(const Image& image, Encoding encoding, bool weight_by_alpha);

    int width() const { return levels_[0].width; }
    int height() const { return levels_[0].height; }
    int level_count() const { return static_cast<int>(levels_.size()); }

    /// Linear colour and opacity in [0, 1] at `uv`, after the texture's transform; v down, (0, 0) the top left corner
    /// of the image. `level` is log2 of the footprint's width in texels of level 0, clamped to the levels there are;
    /// between two levels both are looked up and mixed. `ref` says how edges wrap. Levels are left out only where the
    /// file asks for the nearest texel without levels (drawn pixels); a mere "linear" would alias.
    glm::vec4 sample(const TextureRef& ref, glm::vec2 uv, float level) const;

    /// Opacity alone, bilinear in level 0 whatever `ref.mipmapped` says: for alpha masks.
    float alpha(const TextureRef& ref, glm::vec2 uv) const;

    /// The same of one texel of level 0, as stored.
    std::uint8_t opacity_code(int x, int y) const {
        return opacity_.empty() ? bytes_of(levels_[0])[3] : opacity_[static_cast<std::size_t>(y) * width() + x];
    }

    /// All of them, row by row; null if every texel of level 0 has the same opacity, that of opacity_code(0, 0).
    /// kBeyondCodes more may be read behind the last.
    static constexpr std::size_t kBeyondCodes = 3;
    const std::uint8_t* opacity_codes() const { return opacity_.empty() ? nullptr : opacity_.data(); }

    /// The texels of a level as they are stored: RGBA codes, row by row; and its size.
    std::span<const std::uint8_t> codes(int level) const {
        const Level& from = levels_[level];
        return {bytes_of(from), 4 * static_cast<std::size_t>(from.width) * from.height};
    }
    int width(int level) const { return levels_[level].width; }
    int height(int level) const { return levels_[level].height; }

    /// The same of all levels, one after the other, R in the lowest byte; and where a level begins.
    std::span<const std::uint32_t> texels() const { return texels_; }
    std::size_t first_texel(int level) const { return levels_[level].first; }

    /// What each code of R, G and B stands for: 256 linear values. A stands for code / 255.
    std::span<const float, 256> color_of_code() const { return std::span<const float, 256>(color_of_code_, 256); }

    /// One decoded texel, for tests; x and y inside the level.
    glm::vec4 texel(int level, int x, int y) const;

  private:
    struct Level {
        int width = 1, height = 1;
        std::size_t first = 0;  // into texels_
    };
    const std::uint8_t* bytes_of(const Level& level) const {
        return reinterpret_cast<const std::uint8_t*>(&texels_[level.first]);
    }
    void halve(const Level& fine, const Level& coarse, bool weight_by_alpha);
    glm::vec4 decode(const std::uint8_t* texel) const;
    glm::vec4 bilinear(const Level& level, const TextureRef& ref, glm::vec2 uv) const;
    glm::vec4 nearest(const Level& level, const TextureRef& ref, glm::vec2 uv) const;

    const float* color_of_code_;         // 256 entries
    std::vector<std::uint32_t> texels_;  // bytes R, G, B, A
    std::vector<Level> levels_;
    std::vector<std::uint8_t>
        opacity_;  // level 0 alone, 1 byte a texel: a quarter of the cache; empty if all are opaque
};

/// The pyramids of a scene. An image that serves both as colour and as data is two textures.
class Textures {
  public:
    explicit Textures(const Scene& scene);

    /// Null for kNone, for an index out of range and for an image that no material uses in this way.
    const Pyramid* color(const TextureRef& ref) const { return find(colors_, ref.image); }
    const Pyramid* data(const TextureRef& ref) const { return find(data_, ref.image); }

    /// Of each triangle of a primitive whose material is a mask or blended (scene/opacity_class.h); null for other
    /// ones.
    const OpacityClass* opacity_classes(Index mesh, Index primitive) const {
        const std::vector<OpacityClass>& classes = opacity_classes_[mesh][primitive];
        return classes.empty() ? nullptr : classes.data();
    }

    /// Of each vertex of a primitive whose material has a normal map: the primitive's own, or made
    /// (scene/tangents.h); empty for other ones.
    std::span<const glm::vec4> tangents(Index mesh, Index primitive) const { return tangents_[mesh][primitive]; }

  private:
    using Table = std::vector<std::unique_ptr<const Pyramid>>;  // by index of the image
    static const Pyramid* find(const Table& table, Index image) {
        return image >= 0 && static_cast<std::size_t>(image) < table.size() ? table[image].get() : nullptr;
    }
    Table colors_, data_;
    std::vector<std::vector<std::vector<OpacityClass>>> opacity_classes_;  // [mesh][primitive][triangle]
    std::vector<std::vector<std::vector<glm::vec4>>> tangents_;            // [mesh][primitive][vertex]
};

/// Built once for a scene and handed to each of its frames.
std::shared_ptr<const Textures> make_textures(const Scene& scene);

/// The linear part of a texture's transform, and the whole: uv' = linear * uv + offset. Column-major.
glm::vec4 uv_matrix(const TextureRef& ref);
inline glm::vec2 transform_uv(const TextureRef& ref, glm::vec2 uv) {
    if (ref.rotation == 0.0f) return ref.scale * uv + ref.offset;
    const glm::vec4 m = uv_matrix(ref);
    return {m.x * uv.x + m.z * uv.y + ref.offset.x, m.y * uv.x + m.w * uv.y + ref.offset.y};
}

}  // namespace pentaprism
