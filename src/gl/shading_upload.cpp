#include "gl/shading_upload.h"

#include <array>
#include <fmt/format.h>
#include <map>
#include <pentaprism/error.h>

#include "shade/brdf.h"

namespace pentaprism::gl {
namespace {

constexpr GLenum kStorage = GL_SHADER_STORAGE_BUFFER;

// As the shaders read them (std430).
struct PartRecord {  // shade/shaded_part.glsl
    std::int32_t material = 0, positions = -1, normals = -1, tangents = -1, texcoords = -1, colors = -1;
    std::uint32_t first_point = 0, first_triangle = 0, vertex_count = 0;
    std::int32_t segments = 1, moves = 0, coordinate_sets = 0;
};
static_assert(sizeof(PartRecord) == 48);

struct PyramidRecord {  // scene/texture.glsl
    static constexpr int kMostLevels = 20;
    std::int32_t width, height, level_count, is_color, first[kMostLevels];
};
static_assert(sizeof(PyramidRecord) == 96);

struct TextureRecord {
    std::int32_t pyramid = -1, set = 0, wrap_s = 0, wrap_t = 0;
    float matrix[4] = {1, 0, 0, 1}, offset[2] = {};
    std::int32_t nearest = 0, mipmapped = 1;
};
static_assert(sizeof(TextureRecord) == 48);

struct MaterialRecord {  // shade/shaded_triangle.glsl
    float base_color[4], emissive[4], specular_color[4], sheen_color[4];
    float metallic, roughness, normal_scale, ior, coat, coat_roughness, coat_normal_scale, transmission;
    std::int32_t unlit, textures_used, layered, reflects;
    TextureRecord textures[13];
};
static_assert(sizeof(MaterialRecord) == 736);

struct LightRecord {  // shade/lights.glsl
    float position[4], direction[4], intensity[4], cone_offset;
    std::int32_t share, first_face, faces;
};
static_assert(sizeof(LightRecord) == 64);

struct Tables {  // scene/texture.glsl
    float harmonics[9][4] = {};
    std::int32_t sky_levels[8][4] = {};
    float value_of_code[2][256] = {};
    glm::vec2 specular_albedos[32 * 32] = {};
    float sheen_albedos[16 * 16] = {};
};

struct FaceRecord {  // shade/shadow_map.glsl
    float position[4], right[4], up[4], forward[4];
    std::int32_t perspective, width, least_exponent, unused;
};
static_assert(sizeof(FaceRecord) == 80);

struct WorldPartRecord {  // shade/shadow_lookup.glsl
    std::uint32_t vertex_count;
    std::int32_t segments, moves, unused;
};

template <std::size_t kCount>
void put(float (&out)[kCount], const glm::vec3& v, float w) {
    static_assert(kCount == 4);
    out[0] = v.x, out[1] = v.y, out[2] = v.z, out[3] = w;
}

template <class T>
Buffer storage(const std::vector<T>& values) {
    return Buffer(values.size() * sizeof(T), values.data());
}

glm::vec4 four(const glm::vec3& v) {
    return glm::vec4(v, 0.0f);
}
glm::vec4 four(const glm::vec4& v) {
    return v;
}

// What vertices carry, four numbers each, one after the other.
class Attributes {
  public:
    template <class Vectors>
    std::int32_t add(const Vectors& values) {
        if (values.empty()) return -1;
        const std::size_t first = vectors_.size();
        for (const auto& value : values) vectors_.push_back(four(value));
        return static_cast<std::int32_t>(first);
    }
    /// The same of what all placements of a primitive share.
    std::int32_t add_colors(const Primitive& primitive) {
        const auto [place, is_new] = colors_.emplace(&primitive, -1);
        if (is_new) place->second = add(primitive.colors);
        return place->second;
    }
    std::int32_t add_coordinates(const Primitive& primitive) {
        const auto& [one, two] = primitive.texcoords;
        if (one.empty() && two.empty()) return -1;
        const auto [place, is_new] = coordinates_.emplace(&primitive, static_cast<std::int32_t>(vectors_.size()));
        for (std::size_t i = 0; is_new && i < primitive.positions.size(); ++i)
            vectors_.emplace_back(one.empty() ? glm::vec2(0.0f) : one[i], two.empty() ? glm::vec2(0.0f) : two[i]);
        return place->second;
    }
    const std::vector<glm::vec4>& vectors() const { return vectors_; }

  private:
    std::vector<glm::vec4> vectors_;
    std::map<const Primitive*, std::int32_t> colors_, coordinates_;
};

// Pyramids, each once, and their texels.
class PyramidList {
  public:
    std::int32_t add(const Pyramid* pyramid, bool is_color) {
        if (pyramid == nullptr) return -1;
        const auto [place, is_new] = known_.emplace(pyramid, static_cast<std::int32_t>(records_.size()));
        if (!is_new) return place->second;
        PyramidRecord& record = records_.emplace_back();
        record = {pyramid->width(), pyramid->height(), pyramid->level_count(), is_color ? 1 : 0, {}};
        check_room(pyramid->level_count(), PyramidRecord::kMostLevels, "a texture");
        for (int level = 0; level < pyramid->level_count(); ++level) {
            record.first[level] = static_cast<std::int32_t>(codes_.size() / 4);
            const std::span<const std::uint8_t> codes = pyramid->codes(level);
            codes_.insert(codes_.end(), codes.begin(), codes.end());
        }
        const std::span<const float, 256> values = pyramid->color_of_code();
        std::copy(values.begin(), values.end(), values_.begin() + (is_color ? 256 : 0));
        return place->second;
    }
    const std::vector<PyramidRecord>& records() const { return records_; }
    const std::vector<std::uint8_t>& codes() const { return codes_; }
    const std::vector<float>& values() const { return values_; }

  private:
    std::vector<PyramidRecord> records_;
    std::vector<std::uint8_t> codes_;
    std::vector<float> values_ = std::vector<float>(512);  // of data, of colours
    std::map<const Pyramid*, std::int32_t> known_;
};

TextureRecord texture_record(const BoundTexture& texture, bool is_color, PyramidList& pyramids) {
    TextureRecord out;
    out.pyramid = pyramids.add(texture.pyramid, is_color);
    out.set = texture.set;
    out.wrap_s = static_cast<std::int32_t>(texture.ref.wrap_s);
    out.wrap_t = static_cast<std::int32_t>(texture.ref.wrap_t);
    for (int i = 0; i < 4; ++i) out.matrix[i] = texture.matrix[i];
    out.offset[0] = texture.ref.offset.x, out.offset[1] = texture.ref.offset.y;
    out.nearest = texture.ref.nearest ? 1 : 0;
    out.mipmapped = texture.ref.mipmapped ? 1 : 0;
    return out;
}

MaterialRecord material_record(const BoundMaterial& bound, PyramidList& pyramids) {
    const Material& m = bound.material;
    MaterialRecord out{};
    put(out.base_color, glm::vec3(m.base_color), m.base_color.w);
    put(out.emissive, m.emissive, m.occlusion_strength);
    put(out.specular_color, m.specular_color, m.specular);
    put(out.sheen_color, m.sheen_color, m.sheen_roughness);
    out.metallic = m.metallic, out.roughness = m.roughness, out.normal_scale = m.normal_scale, out.ior = m.ior;
    out.coat = m.clearcoat, out.coat_roughness = m.clearcoat_roughness;
    out.coat_normal_scale = m.clearcoat_normal_scale, out.transmission = m.transmission;
    out.unlit = m.unlit ? 1 : 0, out.layered = bound.layered ? 1 : 0;
    out.reflects = m.ior != 1.5f || m.specular != 1.0f || m.specular_color != glm::vec3(1.0f) ||
                   bound.specular.pyramid || bound.specular_color.pyramid;
    const std::pair<const BoundTexture*, bool> textures[13] = {
        {&bound.base_color, true},      {&bound.metallic_roughness, false},
        {&bound.normal, false},         {&bound.occlusion, false},
        {&bound.emissive, true},        {&bound.specular, false},
        {&bound.specular_color, true},  {&bound.coat, false},
        {&bound.coat_roughness, false}, {&bound.coat_normal, false},
        {&bound.sheen_color, true},     {&bound.sheen_roughness, false},
        {&bound.transmission, false}};
    for (int i = 0; i < 13; ++i) {
        out.textures[i] = texture_record(*textures[i].first, textures[i].second, pyramids);
        if (out.textures[i].pyramid >= 0) out.textures_used = i + 1;
    }
    return out;
}

}  // namespace

void check_room(std::int64_t needed, std::int64_t most, const std::string& what) {
    if (needed <= most) return;
    throw Error(
        ErrorKind::kBackend,
        fmt::format("--backend gl --shading pixel: {} of this scene is too large for this device; use --shading "
                    "decoupled or --backend cpu",
                    what));
}

ShadingUpload::ShadingUpload(const Device& device, const ShadingScene& scene) {
    put_frame(device, scene);
    put_materials(device, scene);
    put_shadows(device, scene);
    put_lights(scene);
    check("sending a scene to be shaded");
}

void ShadingUpload::put_frame(const Device& device, const ShadingScene& scene) {
    const Frame& frame = scene.frame();
    const std::size_t triangles = frame.triangle_count();
    const auto texels = [&](const auto& values, int of_value, GLenum format, const char* what) {
        check_room(static_cast<std::int64_t>(values.size()) * of_value, device.most_texels(), what);
        return TexelBuffer(values.size() * sizeof(values[0]), values.data(), format);
    };
    points_ = texels(frame.points, 1, GL_RGBA32F, "the geometry");
    corners_ = texels(frame.corners, 1, GL_R32UI, "the geometry");
    part_of_ = texels(frame.part_of, 1, GL_R32UI, "the geometry");

    Attributes attributes;
    std::vector<PartRecord> parts;
    for (std::size_t i = 0; i < frame.parts.size(); ++i) {
        const Part& part = frame.parts[i];
        const ShadedPart& shaded = scene.parts()[i];
        PartRecord& out = parts.emplace_back();
        out.positions = attributes.add(shaded.positions);
        out.normals = attributes.add(shaded.normals);
        out.tangents = attributes.add(shaded.tangents);
        out.texcoords = attributes.add_coordinates(*shaded.primitive);
        for (int set = 0; set < 2; ++set)
            if (!shaded.primitive->texcoords[set].empty()) out.coordinate_sets |= 1 << set;
        out.colors = attributes.add_colors(*shaded.primitive);
        out.first_point = part.first_point, out.first_triangle = part.first_triangle;
        out.vertex_count = part.vertex_count;
        out.segments = part.segments, out.moves = part.moves ? 1 : 0;
        check_room(static_cast<std::int64_t>(attributes.vectors().size()), device.most_texels(), "the geometry");
    }
    attributes_ = texels(attributes.vectors(), 1, GL_RGBA32F, "the geometry");
    std::map<const BoundMaterial*, std::int32_t> numbers;  // as put_materials() counts them
    for (std::size_t i = 0; i < parts.size(); ++i)
        parts[i].material =
            numbers.emplace(scene.parts()[i].material, static_cast<std::int32_t>(numbers.size())).first->second;
    parts_ = storage(parts);
    if (frame.pieces.empty()) return;
    std::vector<std::uint32_t> vertices;
    std::vector<float> pieces;
    for (std::uint32_t t = 0; t < triangles; ++t) {
        for (const std::uint32_t v : frame.vertices(t)) vertices.push_back(v);
        for (const glm::vec2& corner : frame.pieces[t].corner) pieces.insert(pieces.end(), {corner.x, corner.y});
    }
    source_vertices_ = texels(vertices, 1, GL_R32UI, "the geometry");
    pieces_ = texels(pieces, 1, GL_R32F, "the geometry");
}

void ShadingUpload::put_materials(const Device& device, const ShadingScene& scene) {
    PyramidList pyramids;
    std::vector<MaterialRecord> materials;
    std::map<const BoundMaterial*, bool> known;
    for (const ShadedPart& part : scene.parts()) {
        if (!known.emplace(part.material, true).second) continue;
        materials.push_back(material_record(*part.material, pyramids));
        check_room(static_cast<std::int64_t>(pyramids.codes().size() / 4), device.most_texels(), "what textures hold");
    }
    check_room(static_cast<std::int64_t>(materials.size() * sizeof(MaterialRecord)), device.most_block_bytes(),
               "the number of materials");
    materials_ = storage(materials);
    pyramids_ = storage(pyramids.records());
    texels_ = TexelBuffer(pyramids.codes().size(), pyramids.codes().data(), GL_RGBA8UI);
    put_tables(scene, pyramids.values());
}

void ShadingUpload::put_tables(const ShadingScene& scene, const std::vector<float>& values) {
    auto tables = std::make_unique<Tables>();
    std::copy(values.begin(), values.end(), &tables->value_of_code[0][0]);
    const auto specular = specular_albedo_table();
    std::copy(specular.begin(), specular.end(), tables->specular_albedos);
    const auto sheen = sheen_albedo_table();
    std::copy(sheen.begin(), sheen.end(), tables->sheen_albedos);
    std::vector<glm::vec4> sky;
    if (const Environment* environment = scene.lighting().environment) {
        for (int k = 0; k < 9; ++k) put(tables->harmonics[k], environment->harmonics()[k], 0.0f);
        for (std::size_t level = 0; level < environment->levels().size(); ++level) {
            const Environment::Map& map = environment->levels()[level];
            tables->sky_levels[level][0] = map.width;
            tables->sky_levels[level][1] = map.height;
            tables->sky_levels[level][2] = static_cast<std::int32_t>(sky.size());
            for (const glm::vec3& texel : map.texels) sky.emplace_back(texel, 0.0f);
        }
    }
    tables_ = Buffer(sizeof(Tables), tables.get());
    sky_ = TexelBuffer(sky.size() * sizeof(glm::vec4), sky.data(), GL_RGBA32F);
}

void ShadingUpload::put_lights(const ShadingScene& scene) {
    std::vector<LightRecord> lights;
    int first_face = 0;
    for (std::size_t i = 0; i < scene.lighting().lights.size(); ++i) {
        const PosedLight& light = scene.lighting().lights[i];
        LightRecord& out = lights.emplace_back();
        put(out.position, light.position, static_cast<float>(static_cast<int>(light.kind)));
        put(out.direction, light.direction, light.range < INFINITY && light.range > 0.0f ? light.range : 0.0f);
        put(out.intensity, light.intensity, light.cone_scale);
        out.cone_offset = light.cone_offset;
        const bool casts = scene.shadows().casts(i);
        out.share = casts ? casting_++ : -1;
        out.first_face = first_face;
        out.faces = casts ? static_cast<std::int32_t>(scene.shadows().faces(i).size()) : 0;
        first_face += out.faces;
    }
    lights_ = storage(lights);
}

void ShadingUpload::put_shadows(const Device& device, const ShadingScene& scene) {
    const Shadows& shadows = scene.shadows();
    std::vector<FaceRecord> faces;
    for (std::size_t i = 0; i < scene.lighting().lights.size(); ++i) {
        if (!shadows.casts(i)) continue;
        for (const auto& map : shadows.faces(i)) {
            const LightView& view = map->view();
            FaceRecord& out = faces.emplace_back();
            put(out.position, view.position, 0.0f);
            put(out.right, view.axes[0], 0.0f);
            put(out.up, view.axes[1], 0.0f);
            put(out.forward, view.axes[2], 0.0f);
            out.perspective = view.perspective ? 1 : 0;
            out.width = map->width();
            out.least_exponent = map->least_exponent();
            maps_.push_back(map.get());
        }
    }
    faces_ = storage(faces);
    if (!shadows.any()) return;
    const WorldMotion& world = shadows.world();
    std::vector<WorldPartRecord> parts;
    for (const Part& part : world.parts)
        parts.push_back({part.vertex_count, part.moves ? part.segments : 1, part.moves ? 1 : 0, 0});
    world_parts_ = storage(parts);
    check_room(static_cast<std::int64_t>(world.points.size()), device.most_texels(), "the geometry");
    std::vector<glm::vec4> points;
    points.reserve(world.points.size());
    for (const glm::vec3& point : world.points) points.push_back(four(point));
    world_points_ = TexelBuffer(points.size() * sizeof(glm::vec4), points.data(), GL_RGBA32F);
    const std::uint32_t triangles = world.frame->triangle_count();
    std::vector<std::uint32_t> corners;
    corners.reserve(3 * std::size_t{triangles});
    for (std::uint32_t triangle = 0; triangle < triangles; ++triangle)
        for (const std::uint32_t corner : world.corners(triangle)) corners.push_back(corner);
    world_corners_ = TexelBuffer(corners.size() * sizeof(std::uint32_t), corners.data(), GL_R32UI);
    std::vector<glm::vec4> samples;
    for (const ShadowSamples::Cell& cell : shadows.samples().cells())
        for (int i = 0; i < ShadowSamples::kPerCell; ++i) samples.emplace_back(cell.x[i], cell.y[i], cell.t[i], 0.0f);
    map_samples_ = TexelBuffer(samples.size() * sizeof(glm::vec4), samples.data(), GL_RGBA32F);
}

void ShadingUpload::set_uniforms(const Program& program, const ShadingScene& scene) const {
    const View& view = scene.frame().view;
    const Lens& lens = view.lens;
    const Lighting& lighting = scene.lighting();
    const ShadingOptions& options = scene.options();
    program.set("w_near", view.w_near());
    program.set("lens_ratio", lens.ratio);
    program.set("picture_width", view.width);
    program.set("picture_height", view.height);
    program.set("orthographic", view.perspective ? 0 : 1);
    program.set("view_perspective", view.perspective ? 1 : 0);
    program.set("focal_length", view.fx);
    program.set("depth_near", view.depth_near);
    program.set("lens_a", lens.a);
    program.set("lens_b", lens.b);
    program.set("lens_straight", lens.straight() ? 1 : 0);
    program.set("lens_has_range", lens.sharp_range ? 1 : 0);
    program.set("lens_range_from", lens.sharp_range ? (*lens.sharp_range)[0] : 0.0);
    program.set("lens_range_to", lens.sharp_range ? (*lens.sharp_range)[1] : 0.0);
    program.set("lens_foreground", std::min(lens.max_foreground_px, 1e300));
    program.set("with_pieces", scene.frame().pieces.empty() ? 0 : 1);
    const glm::vec3& back = scene.backwards();
    program.set("backwards", back.x, back.y, back.z, 0.0f);
    program.set("texture_filter", static_cast<int>(options.texture_filter));
    program.set("brdf_model", static_cast<int>(options.brdf));
    program.set("light_count", static_cast<int>(lighting.lights.size()));
    program.set("casting_lights", casting_);
    program.set("with_ambient", lighting.ambient() ? 1 : 0);
    program.set("with_environment", lighting.environment ? 1 : 0);
    program.set("sky_light", lighting.sky.x, lighting.sky.y, lighting.sky.z, 0.0f);
    program.set("ground_light", lighting.ground.x, lighting.ground.y, lighting.ground.z, 0.0f);
    program.set("by_quarters", scene.shadows().move() ? 1 : 0);
    program.set("with_lanes", casting_ > 0 ? 1 : 0);
    if (scene.shadows().any()) program.set("map_seed", scene.shadows().samples().seed());
}

void ShadingUpload::bind_gather() const {
    parts_.bind(kStorage, 2);
    points_.bind(0);
    corners_.bind(1);
    part_of_.bind(3);
}

void ShadingUpload::bind_points() const {
    bind_gather();
    materials_.bind(kStorage, 3);
    pyramids_.bind(kStorage, 4);
    lights_.bind(kStorage, 5);
    tables_.bind(kStorage, 6);
    texels_.bind(4);
    attributes_.bind(5);
    source_vertices_.bind(6);
    pieces_.bind(7);
    sky_.bind(8);
}

void ShadingUpload::bind_shadows() const {
    world_parts_.bind(kStorage, 2);
    faces_.bind(kStorage, 3);
    lights_.bind(kStorage, 5);
    part_of_.bind(3);
    world_points_.bind(9);
    world_corners_.bind(10);
    map_samples_.bind(11);
}

}  // namespace pentaprism::gl
