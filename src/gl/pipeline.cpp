#include "gl/pipeline.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "cover/hits.h"
#include "gl/culling.h"

namespace pentaprism::gl {
namespace {

constexpr GLuint kSampleUnit = 0, kOpacityUnits = 1, kSeenUnit = 0, kTestedImage = 0, kCoveredImage = 1;

const Program& raster_program(Device& device, const std::string& culling) {
    const Culling steps = parse_gl_culling(culling);
    const std::string shader = culling_shader(steps);
    return device.program("raster " + shader, [&] {
        const ShaderSource extra[] = {{"culling", shader}};
        std::vector<std::string> defines = device.defines();
        if (asks_hull_of_pixels(steps)) defines.emplace_back("DRAW_HULL");
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

void set_view(const Program& program, const View& view) {
    program.set("w_near", view.w_near());
    program.set("lens_ratio", view.lens.ratio);
    program.set("z_near", static_cast<float>(view.depth_near));
    program.set("z_far", static_cast<float>(view.depth_far));
    program.set("picture_width", view.width);
    program.set("picture_height", view.height);
    program.set("orthographic", view.perspective ? 0 : 1);
}

Object<TextureKind> counter_image(int width, int height) {
    Object<TextureKind> image = make_texture(GL_TEXTURE_2D);
    glTextureStorage2D(image, 1, GL_R32UI, width, height);
    return image;
}

void clear_counters(GLuint image) {
    constexpr GLuint kZero = 0;
    glClearTexImage(image, 0, GL_RED_INTEGER, GL_UNSIGNED_INT, &kZero);
}

std::vector<std::uint32_t> read_counters(GLuint image, const Region& region) {
    std::vector<std::uint32_t> counts(static_cast<std::size_t>(region.width()) * region.height());
    glGetTextureSubImage(image, 0, 0, 0, 0, region.width(), region.height(), 1, GL_RED_INTEGER, GL_UNSIGNED_INT,
                         static_cast<GLsizei>(counts.size() * sizeof(std::uint32_t)), counts.data());
    return counts;
}

}  // namespace

Pipeline::Pipeline(Device& device, const Frame& frame, const SampleTable& table, const std::string& culling,
                   const Region& largest)
    : frame_(frame),
      table_(table),
      slots_(std::min(device.samples(), table.slots())),
      width_(largest.cell_columns * kCellSize),
      height_(largest.cell_rows * kCellSize),
      geometry_(frame),
      opacity_(frame),
      samples_(static_cast<std::size_t>(width_) * height_ * slots_),
      raster_(raster_program(device, culling)),
      collector_(collector_program(device)),
      collected_(static_cast<std::size_t>(width_) * height_ * slots_ * sizeof(glm::uvec2)),
      seen_(make_texture(GL_TEXTURE_2D_MULTISAMPLE)),
      tested_(counter_image(width_, height_)),
      covered_(counter_image(width_, height_)),
      depth_(make_renderbuffer()),
      framebuffer_(gl::make_framebuffer()) {
    glTextureStorage2DMultisample(seen_, slots_, GL_RG32UI, width_, height_, GL_TRUE);
    glNamedRenderbufferStorageMultisample(depth_, slots_, GL_DEPTH_COMPONENT32F, width_, height_);
    glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, seen_, 0);
    glNamedFramebufferRenderbuffer(framebuffer_, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
    check("making the buffers of a frame");
}

void Pipeline::set_uniforms(const Region& region, int pass_slots) const {
    for (const Program* program : {&raster_, &collector_}) {
        const PixelRect& p = region.pixels;
        program->set("region", p.x0, p.x1, p.y0, p.y1);
        program->set("region_cell", region.cell_x, region.cell_y);
        program->set("region_cell_columns", region.cell_columns);
        program->set("pass_slots", pass_slots);
        set_view(*program, frame_.view);
    }
    raster_.set("samples_per_pixel", table_.spp());
}

void Pipeline::draw() const {
    raster_.use();
    geometry_.bind();
    opacity_.bind(kOpacityUnits);
    for (std::size_t p = 0; p < frame_.parts.size(); ++p) {
        const Part& part = frame_.parts[p];
        opacity_.set(raster_, p);
        const int segments = part.moves ? part.segments : 1;
        raster_.set("first_triangle", part.first_triangle);
        raster_.set("two_sided", part.two_sided ? 1 : 0);
        raster_.set("segments", static_cast<float>(segments));
        // Segments share no sample, so that only the order of triangles within one decides between equal depths.
        for (int segment = 0; segment < segments; ++segment) {
            raster_.set("segment", static_cast<float>(segment));
            geometry_.draw(part, segment);
        }
    }
}

void Pipeline::collect(const Region& region, int first_slot, int pass_slots, RegionHits& hits) {
    collector_.use();
    glBindTextureUnit(kSeenUnit, seen_);
    collected_.bind(GL_SHADER_STORAGE_BUFFER, 0);
    glDispatchCompute((region.width() + 7) / 8, (region.height() + 7) / 8, 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    const std::size_t blocks = static_cast<std::size_t>(region.cells()) * kBlocksPerCell;
    const std::size_t of_block = static_cast<std::size_t>(pass_slots) * kLanes;
    received_.resize(blocks * of_block);
    collected_.read(0, received_.size() * sizeof(glm::uvec2), received_.data());
    for (std::size_t block = 0; block < blocks; ++block)
        for (std::size_t i = 0; i < of_block; ++i) {
            const glm::uvec2 hit = received_[block * of_block + i];
            if (hit.x == kNoTriangle) continue;
            const std::size_t to = (block * table_.slots() + first_slot) * kLanes + i;
            hits.triangle[to] = hit.x;
            hits.depth[to] = std::bit_cast<float>(hit.y);
        }
}

RegionHits Pipeline::render(const Region& region) {
    RegionHits hits;
    const std::size_t samples = static_cast<std::size_t>(region.cells()) * kBlocksPerCell * table_.slots() * kLanes;
    hits.depth.assign(samples, std::numeric_limits<float>::infinity());
    hits.triangle.assign(samples, kNoTriangle);

    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glViewport(0, 0, region.width(), region.height());
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);    // of equal depths the first stays
    glEnable(GL_CULL_FACE);  // bounds are front faces, except slivers that rounding turned over
    clear_counters(tested_);
    clear_counters(covered_);
    glBindImageTexture(kTestedImage, tested_, 0, GL_FALSE, 0, GL_READ_WRITE, GL_R32UI);
    glBindImageTexture(kCoveredImage, covered_, 0, GL_FALSE, 0, GL_READ_WRITE, GL_R32UI);
    for (int first = 0; first < table_.slots(); first += slots_) {
        const int count = std::min(slots_, table_.slots() - first);
        samples_.write(table_, region, first, count);
        constexpr GLuint kNothing[4] = {kNoTriangle, 0, 0, 0};
        constexpr float kFarthest = 1.0f;
        glClearNamedFramebufferuiv(framebuffer_, GL_COLOR, 0, kNothing);
        glClearNamedFramebufferfv(framebuffer_, GL_DEPTH, 0, &kFarthest);
        set_uniforms(region, count);
        samples_.bind(kSampleUnit);
        draw();
        collect(region, first, count, hits);
    }
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    hits.tested = read_counters(tested_, region);
    hits.covered = read_counters(covered_, region);
    check("rendering");
    return hits;
}

}  // namespace pentaprism::gl
