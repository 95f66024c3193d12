#include "gl/opacity_upload.h"

#include <glm/vec4.hpp>
#include <map>
#include <vector>

namespace pentaprism::gl {
namespace {

// As surface_of() in frame/opacity.glsl reads them.
struct TextureRecord {
    std::int32_t size[2] = {}, wrap[2] = {};
    float matrix[4] = {};
    float offset[2] = {};
    std::int32_t first_code = 0;
    std::uint32_t flags = 0;  // nearest texel, turned
};
struct SurfaceRecord {
    std::int32_t mode = 0;
    std::uint32_t flags = 0;  // corners' alphas, texture, glass, texture of glass, alpha blends
    std::int32_t first_record = 0, stride = kPlainRecord;
    float cutoff = 0, factor = 0, texture_alpha = 0, transmission = 0;
    TextureRecord texture, of_glass;

    static constexpr std::int32_t kPlainRecord = 3, kGlassRecord = 5;  // vectors of a triangle
};
static_assert(sizeof(SurfaceRecord) == 8 * 4 * sizeof(float));

// Codes of textures, each once.
class Codes {
  public:
    /// Place of the first one. `channel`: of RGBA; 3 is the opacity.
    std::int32_t add(const Pyramid& pyramid, int channel) {
        const auto [place, is_new] = first_.emplace(std::pair(&pyramid, channel), static_cast<int>(codes_.size()));
        if (!is_new) return place->second;
        const std::span<const std::uint8_t> texels = pyramid.codes(0);
        for (std::size_t i = channel; i < texels.size(); i += 4) codes_.push_back(texels[i]);
        return place->second;
    }
    const std::vector<std::uint8_t>& all() const { return codes_; }

  private:
    std::vector<std::uint8_t> codes_;
    std::map<std::pair<const Pyramid*, int>, std::int32_t> first_;
};

TextureRecord texture_record(const Pyramid& pyramid, const TextureRef& ref, int channel, Codes& codes) {
    TextureRecord out;
    out.size[0] = pyramid.width();
    out.size[1] = pyramid.height();
    out.wrap[0] = static_cast<std::int32_t>(ref.wrap_s);
    out.wrap[1] = static_cast<std::int32_t>(ref.wrap_t);
    const glm::vec4 matrix = uv_matrix(ref);
    for (int i = 0; i < 4; ++i) out.matrix[i] = matrix[i];
    out.offset[0] = ref.offset.x;
    out.offset[1] = ref.offset.y;
    out.first_code = codes.add(pyramid, channel);
    out.flags = (ref.nearest ? 1u : 0u) | (ref.rotation != 0.0f ? 2u : 0u);
    return out;
}

void set_terms(const OpacityTerms& terms, SurfaceRecord& surface, Codes& codes) {
    surface.flags = (terms.colored ? 1u : 0u) | (terms.texture ? 2u : 0u) | (terms.glass ? 4u : 0u) |
                    (terms.transmission_texture ? 8u : 0u) | (terms.blends ? 16u : 0u);
    surface.cutoff = terms.cutoff;
    surface.factor = terms.factor;
    surface.texture_alpha = terms.texture_alpha;
    surface.transmission = terms.transmission;
    if (terms.texture) surface.texture = texture_record(*terms.texture, *terms.ref, 3, codes);
    if (!terms.glass) return;
    surface.stride = SurfaceRecord::kGlassRecord;
    if (terms.transmission_texture)
        surface.of_glass = texture_record(*terms.transmission_texture, *terms.transmission_ref, 0, codes);
}

void append_triangle(const Frame& frame, std::uint32_t triangle, std::vector<glm::vec4>& records) {
    const OpacityTerms terms = opacity_terms(frame, triangle);
    const float known = static_cast<float>(static_cast<int>(opacity_class(frame, triangle)));
    records.emplace_back(terms.uv[0].x, terms.uv[0].y, terms.uv[1].x, terms.uv[1].y);
    records.emplace_back(terms.uv[2].x, terms.uv[2].y, known, 0.0f);
    records.emplace_back(terms.color[0], terms.color[1], terms.color[2], 0.0f);
    if (!terms.glass) return;
    const glm::vec2* uv = terms.transmission_uv;
    records.emplace_back(uv[0].x, uv[0].y, uv[1].x, uv[1].y);
    records.emplace_back(uv[2].x, uv[2].y, 0.0f, 0.0f);
}

}  // namespace

OpacityUpload::OpacityUpload(const Frame& frame) {
    std::vector<glm::vec4> records;
    std::vector<SurfaceRecord> surfaces;
    Codes codes;
    for (const Part& part : frame.parts) {
        SurfaceRecord& surface = surfaces.emplace_back();
        if (part.alpha_mode == AlphaMode::kOpaque || part.material == kNone || part.triangle_count == 0) continue;
        // All but uv and colours are the same for all triangles.
        surface.mode = static_cast<std::int32_t>(part.alpha_mode);
        surface.first_record = static_cast<std::int32_t>(records.size());
        set_terms(opacity_terms(frame, part.first_triangle), surface, codes);
        for (std::uint32_t t = 0; t < part.triangle_count; ++t)
            append_triangle(frame, part.first_triangle + t, records);
    }
    records_ = Buffer(records.size() * sizeof(glm::vec4), records.data());
    codes_ = Buffer(codes.all().size(), codes.all().data());
    surfaces_ = Buffer(surfaces.size() * sizeof(SurfaceRecord), surfaces.data());
    record_view_ = view_of(records_, GL_RGBA32F);
    code_view_ = view_of(codes_, GL_R8UI);
    surface_view_ = view_of(surfaces_, GL_RGBA32UI);
}

void OpacityUpload::bind(GLuint first) const {
    glBindTextureUnit(first, record_view_);
    glBindTextureUnit(first + 1, code_view_);
    glBindTextureUnit(first + 2, surface_view_);
}

}  // namespace pentaprism::gl
