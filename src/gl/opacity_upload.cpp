#include "gl/opacity_upload.h"

#include <fmt/format.h>
#include <glm/vec4.hpp>
#include <map>
#include <pentaprism/error.h>

namespace pentaprism::gl {
namespace {

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
    std::map<const Pyramid*, int> first_code;  // textures that were met before
    for (const Part& part : frame.parts) {
        Surface& surface = surfaces_.emplace_back();
        if (part.alpha_mode == AlphaMode::kOpaque || part.material == kNone || part.triangle_count == 0) continue;
        surface.mode = part.alpha_mode;
        surface.terms = opacity_terms(frame, part.first_triangle);
        if (surface.terms.glass) refuse_glass(frame, part);
        surface.first_record = static_cast<int>(records.size() / 3);
        for (std::uint32_t t = 0; t < part.triangle_count; ++t)
            append_triangle(frame, part.first_triangle + t, records);
        const Pyramid* texture = surface.terms.texture;
        if (texture == nullptr) continue;
        const auto [place, is_new] = first_code.emplace(texture, static_cast<int>(codes.size()));
        surface.first_code = place->second;
        const std::size_t texels = static_cast<std::size_t>(texture->width()) * texture->height();
        if (is_new) codes.insert(codes.end(), texture->opacity_codes(), texture->opacity_codes() + texels);
    }
    records_ = Buffer(records.size() * sizeof(glm::vec4), records.data());
    codes_ = Buffer(codes.size(), codes.data());
    record_view_ = view_of(records_, GL_RGBA32F);
    code_view_ = view_of(codes_, GL_R8UI);
}

void OpacityUpload::bind(GLuint first) const {
    glBindTextureUnit(first, record_view_);
    glBindTextureUnit(first + 1, code_view_);
}

void OpacityUpload::set(const Program& program, std::size_t part) const {
    const Surface& surface = surfaces_[part];
    program.set("alpha_mode", static_cast<int>(surface.mode));
    if (surface.mode == AlphaMode::kOpaque) return;
    const OpacityTerms& terms = surface.terms;
    program.set("alpha_cutoff", terms.cutoff);
    program.set("alpha_factor", terms.factor);
    program.set("corner_alphas", terms.colored ? 1 : 0);
    program.set("texture_alpha", terms.texture_alpha);
    program.set("first_record", surface.first_record);
    program.set("textured", terms.texture != nullptr ? 1 : 0);
    if (terms.texture == nullptr) return;
    const glm::vec4 matrix = uv_matrix(*terms.ref);
    program.set("first_code", surface.first_code);
    program.set("texture_size", terms.texture->width(), terms.texture->height());
    program.set("texture_wrap", static_cast<int>(terms.ref->wrap_s), static_cast<int>(terms.ref->wrap_t));
    program.set("nearest_texel", terms.ref->nearest ? 1 : 0);
    program.set("texture_turned", terms.ref->rotation != 0.0f ? 1 : 0);
    program.set("texture_matrix", matrix.x, matrix.y, matrix.z, matrix.w);
    program.set("texture_offset", terms.ref->offset.x, terms.ref->offset.y);
}

}  // namespace pentaprism::gl
