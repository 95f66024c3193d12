#include "gl/raster_pass.h"

#include "cover/hits.h"

namespace pentaprism::gl {
namespace {

const Program& raster_program(Device& device, const Culling& culling) {
    const std::string shader = culling_shader(culling);
    return device.program("raster " + shader, [&] {
        const ShaderSource extra[] = {{"culling", shader}};
        std::vector<std::string> defines = device.defines();
        if (asks_hull_of_pixels(culling)) defines.emplace_back("DRAW_HULL");
        return Program({{GL_VERTEX_SHADER, "gl/raster.vert.glsl"},
                        {GL_GEOMETRY_SHADER, "gl/raster.geom.glsl"},
                        {GL_FRAGMENT_SHADER, "gl/raster.frag.glsl"}},
                       defines, extra);
    });
}

const Program& collector_program(Device& device) {
    return device.program("collect", [&] {
        return Program({{GL_COMPUTE_SHADER, "gl/collect.comp.glsl"}}, device.defines());
    });
}

}  // namespace

RasterPass::RasterPass(Device& device, const PassData& data, const Culling& culling, int width, int height, int slots)
    : data_(data),
      raster_(raster_program(device, culling)),
      collector_(collector_program(device)),
      seen_(make_texture(GL_TEXTURE_2D_MULTISAMPLE)),
      depth_(make_renderbuffer()),
      framebuffer_(make_framebuffer()) {
    glTextureStorage2DMultisample(seen_, slots, GL_RG32UI, width, height, GL_TRUE);
    glNamedRenderbufferStorageMultisample(depth_, slots, GL_DEPTH_COMPONENT32F, width, height);
    glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, seen_, 0);
    glNamedFramebufferRenderbuffer(framebuffer_, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
}

void RasterPass::draw() const {
    raster_.use();
    data_.geometry.bind();
    for (std::size_t p = 0; p < data_.frame.parts.size(); ++p) {
        const Part& part = data_.frame.parts[p];
        const int segments = part.moves ? part.segments : 1;
        raster_.set("part", static_cast<int>(p));
        raster_.set("first_triangle", part.first_triangle);
        raster_.set("two_sided", part.two_sided ? 1 : 0);
        raster_.set("segments", static_cast<float>(segments));
        // Segments share no sample, so that only the order of triangles within one decides between equal depths.
        for (int segment = 0; segment < segments; ++segment) {
            raster_.set("segment", static_cast<float>(segment));
            data_.geometry.draw(part, segment);
        }
    }
}

void RasterPass::run(const Region& region, int count, bool) {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glViewport(0, 0, region.width(), region.height());
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);    // of equal depths the first stays
    glEnable(GL_CULL_FACE);  // bounds are front faces, except slivers that rounding turned over
    constexpr GLuint kNothing[4] = {kNoTriangle, 0, 0, 0};
    constexpr float kFarthest = 1.0f;
    glClearNamedFramebufferuiv(framebuffer_, GL_COLOR, 0, kNothing);
    glClearNamedFramebufferfv(framebuffer_, GL_DEPTH, 0, &kFarthest);
    for (const Program* program : {&raster_, &collector_}) set_uniforms(*program, data_, region, count);
    data_.samples.bind(kSampleUnit);
    data_.opacity.bind(kOpacityUnits);
    draw();
    collector_.use();
    glBindTextureUnit(kSeenUnit, seen_);
    data_.hits.bind(GL_SHADER_STORAGE_BUFFER, kHitsBlock);
    glDispatchCompute((region.width() + 7) / 8, (region.height() + 7) / 8, 1);
}

}  // namespace pentaprism::gl
