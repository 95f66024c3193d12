#include "gl/opacity_upload.h"

#include <fmt/format.h>
#include <glm/vec4.hpp>
#include <map>
#include <pentaprism/error.h>
#include <vector>

namespace pentaprism::gl {
namespace {

// As surface_of() in frame/opacity.glsl reads it: five times four numbers.
struct SurfaceRecord {
    std::int32_t mode = 0;
    std::uint32_t flags = 0;  // corners' alphas, texture, nearest texel, turned texture
    std::int32_t first_record = 0, first_code = 0;
    float cutoff = 0, factor = 0, texture_alpha = 0, unused_b = 0;
    std::int32_t size[2] = {}, wrap[2] = {};
    float matrix[4] = {};
    float offset[2] = {}, unused_e[2] = {};
};
static_assert(sizeof(SurfaceRecord) == 5 * 4 * sizeof(float));

void set_terms(const OpacityTerms& terms, SurfaceRecord& surface) {
    surface.flags = terms.colored ? 1 : 0;
    surface.cutoff = terms.cutoff;
    surface.factor = terms.factor;
    surface.texture_alpha = terms.texture_alpha;
    if (terms.texture == nullptr) return;
    surface.flags |= 2u | (terms.ref->nearest ? 4u : 0u) | (terms.ref->rotation != 0.0f ? 8u : 0u);
    surface.size[0] = terms.texture->width();
    surface.size[1] = terms.texture->height();
    surface.wrap[0] = static_cast<std::int32_t>(terms.ref->wrap_s);
    surface.wrap[1] = static_cast<std::int32_t>(terms.ref->wrap_t);
    const glm::vec4 matrix = uv_matrix(*terms.ref);
    for (int i = 0; i < 4; ++i) surface.matrix[i] = matrix[i];
    surface.offset[0] = terms.ref->offset.x;
    surface.offset[1] = terms.ref->offset.y;
}

void append_triangle(const Frame& frame, std::uint32_t triangle, std::vector<glm::vec4>& records) {
    const OpacityTerms terms = opacity_terms(frame, triangle);
    const float known = static_cast<float>(static_cast<int>(opacity_class(frame, triangle)));
    records.emplace_back(terms.uv[0].x, terms.uv[0].y, terms.uv[1].x, terms.uv[1].y);
    records.emplace_back(terms.uv[2].x, terms.uv[2].y, known, 0.0f);
    records.emplace_back(terms.color[0], terms.color[1], terms.color[2], 0.0f);
}

Object<TextureKind> view_of(const Buffer& buffer, GLenum format) {
    Object<TextureKind> view = make_texture(GL_TEXTURE_BUFFER);
    glTextureBuffer(view, format, buffer);
    return view;
}

[[noreturn]] void refuse_glass(const Frame& frame, const Part& part) {
    throw Error(ErrorKind::kBackend,
                fmt::format("--backend gl: material '{}' lets light through (KHR_materials_transmission), which only "
                            "--backend cpu can do",
                            frame.scene->materials[part.material].name));
}

}  // namespace

OpacityUpload::OpacityUpload(const Frame& frame) {
    std::vector<glm::vec4> records;
    std::vector<std::uint8_t> codes;
    std::vector<SurfaceRecord> surfaces;
    std::map<const Pyramid*, int> first_code;  // textures that were met before
    for (const Part& part : frame.parts) {
        SurfaceRecord& surface = surfaces.emplace_back();
        if (part.alpha_mode == AlphaMode::kOpaque || part.material == kNone || part.triangle_count == 0) continue;
        // All but uv and colours are the same for all triangles.
        const OpacityTerms terms = opacity_terms(frame, part.first_triangle);
        if (terms.glass) refuse_glass(frame, part);
        surface.mode = static_cast<std::int32_t>(part.alpha_mode);
        surface.first_record = static_cast<std::int32_t>(records.size() / 3);
        set_terms(terms, surface);
        for (std::uint32_t t = 0; t < part.triangle_count; ++t)
            append_triangle(frame, part.first_triangle + t, records);
        const Pyramid* texture = terms.texture;
        if (texture == nullptr) continue;
        const auto [place, is_new] = first_code.emplace(texture, static_cast<int>(codes.size()));
        surface.first_code = place->second;
        const std::size_t texels = static_cast<std::size_t>(texture->width()) * texture->height();
        if (is_new) codes.insert(codes.end(), texture->opacity_codes(), texture->opacity_codes() + texels);
    }
    records_ = Buffer(records.size() * sizeof(glm::vec4), records.data());
    codes_ = Buffer(codes.size(), codes.data());
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
