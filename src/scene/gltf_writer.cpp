// Writes a Scene as binary glTF 2.0 (https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html, section 4.4 for the
// container). Every accessor has a buffer view of its own, tightly packed, in the order of the scene's vectors, so that
// the same scene gives the same bytes. Lens and shutter data go into the camera's `extras`; see the reader for their
// names.

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <pentaprism/error.h>
#include <pentaprism/scene.h>
#include <set>
#include <span>

#include "image/part_file.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb_image_write.h>
#pragma GCC diagnostic pop

namespace pentaprism {
namespace {

// Keeps the order of insertion. A new key may move the values of the others: hold no reference across one.
using Json = nlohmann::ordered_json;

// glTF's numbers for what it has no words for.
enum ComponentType { kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126 };
enum Target { kNoTarget = 0, kArrayBuffer = 34962, kElementArrayBuffer = 34963 };
enum Sampler {
    kNearest = 9728,
    kLinear = 9729,
    kNearestMipmapLinear = 9986,
    kLinearMipmapLinear = 9987,
    kClampToEdge = 33071,
    kMirroredRepeat = 33648,
    kRepeat = 10497
};

Json json(glm::dvec3 v) {
    return {v.x, v.y, v.z};
}
Json json(glm::dquat q) {
    return {q.x, q.y, q.z, q.w};
}
const char* vector_type(int width) {
    return std::array{"", "SCALAR", "VEC2", "VEC3", "VEC4"}[std::size_t(width)];
}

class Writer {
  public:
    explicit Writer(const Scene& scene) : scene_(scene) {}
    std::string document();

  private:
    // The binary chunk.
    int add_view(const void* data, std::size_t bytes, Target target);
    int add_accessor(const void* data, std::size_t count, std::size_t stride, ComponentType component, const char* type,
                     Target target);
    int add_floats(std::span<const float> values, int width, bool bounds, Target target = kNoTarget);
    template <class Vector>
    int add_vectors(const std::vector<Vector>& values, bool bounds = false) {
        return add_floats({&values[0][0], values.size() * std::size_t(Vector::length())}, Vector::length(), bounds,
                          kArrayBuffer);
    }
    int add_indices(const std::vector<std::uint32_t>& indices);

    // One step for each of the scene's vectors.
    void images();
    void materials();
    void material_extensions(const Material& m, Json& out);
    void meshes();
    void skins();
    void cameras();
    void lights();
    void nodes();
    void animations();

    Json texture_info(const TextureRef& ref);
    Json primitive(const Primitive& primitive);
    Json instancing(const std::vector<Transform>& instances);
    void use(const char* extension) { extensions_.insert(extension); }

    const Scene& scene_;
    Json root_;
    std::vector<char> binary_;
    std::set<std::string> extensions_;
    std::map<std::array<int, 4>, int> samplers_;     // wrap s, wrap t, min, mag -> index
    std::map<std::pair<Index, int>, int> textures_;  // image, sampler -> index
    std::map<std::vector<float>, int> key_times_;    // channels often share their times
};

int Writer::add_view(const void* data, std::size_t bytes, Target target) {
    binary_.resize((binary_.size() + 3) / 4 * 4);
    Json view{{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes}};
    if (target != kNoTarget) view["target"] = int(target);
    const auto* first = static_cast<const char*>(data);
    binary_.insert(binary_.end(), first, first + bytes);
    root_["bufferViews"].push_back(std::move(view));
    return static_cast<int>(root_["bufferViews"].size()) - 1;
}

int Writer::add_accessor(const void* data, std::size_t count, std::size_t stride, ComponentType component,
                         const char* type, Target target) {
    const int view = add_view(data, count * stride, target);
    root_["accessors"].push_back(
        {{"bufferView", view}, {"componentType", int(component)}, {"count", count}, {"type", type}});
    return static_cast<int>(root_["accessors"].size()) - 1;
}

int Writer::add_floats(std::span<const float> values, int width, bool bounds, Target target) {
    const std::size_t count = values.size() / std::size_t(width);
    const int index =
        add_accessor(values.data(), count, sizeof(float) * std::size_t(width), kFloat, vector_type(width), target);
    if (bounds) {
        Json low, high;
        for (std::size_t k = 0; k < std::size_t(width); ++k) {
            float least = values[k], most = values[k];
            for (std::size_t i = k; i < values.size(); i += std::size_t(width)) {
                least = std::min(least, values[i]);
                most = std::max(most, values[i]);
            }
            low.push_back(least);
            high.push_back(most);
        }
        root_["accessors"].back()["min"] = low;
        root_["accessors"].back()["max"] = high;
    }
    return index;
}

int Writer::add_indices(const std::vector<std::uint32_t>& indices) {
    // 65535 itself would mean "restart" and is not allowed.
    if (std::all_of(indices.begin(), indices.end(), [](std::uint32_t i) { return i < 65535; })) {
        const std::vector<std::uint16_t> narrow(indices.begin(), indices.end());
        return add_accessor(narrow.data(), narrow.size(), 2, kUnsignedShort, "SCALAR", kElementArrayBuffer);
    }
    return add_accessor(indices.data(), indices.size(), 4, kUnsignedInt, "SCALAR", kElementArrayBuffer);
}

void Writer::images() {
    for (const Image& image : scene_.images) {
        std::vector<std::uint8_t> png;
        const auto append = [](void* context, void* data, int size) {
            const auto* first = static_cast<const std::uint8_t*>(data);
            auto& bytes = *static_cast<std::vector<std::uint8_t>*>(context);
            bytes.insert(bytes.end(), first, first + size);
        };
        if (!stbi_write_png_to_func(append, &png, image.width, image.height, 4, image.texels.data(), 4 * image.width))
            throw Error(ErrorKind::kOutput,
                        fmt::format("image '{}' of {}: cannot be encoded as PNG", image.name, scene_.name));
        const int view = add_view(png.data(), png.size(), kNoTarget);
        root_["images"].push_back({{"name", image.name}, {"bufferView", view}, {"mimeType", "image/png"}});
    }
}

Json Writer::texture_info(const TextureRef& ref) {
    const auto wrap = [](Wrap w) {
        return w == Wrap::kRepeat ? kRepeat : w == Wrap::kClampToEdge ? kClampToEdge : kMirroredRepeat;
    };
    const int magnify = ref.nearest ? kNearest : kLinear;
    const int minify = !ref.mipmapped ? magnify : ref.nearest ? kNearestMipmapLinear : kLinearMipmapLinear;
    const std::array<int, 4> key{wrap(ref.wrap_s), wrap(ref.wrap_t), minify, magnify};
    const auto [sampler, new_sampler] = samplers_.try_emplace(key, static_cast<int>(samplers_.size()));
    if (new_sampler)
        root_["samplers"].push_back(
            {{"magFilter", key[3]}, {"minFilter", key[2]}, {"wrapS", key[0]}, {"wrapT", key[1]}});
    const auto [texture, new_texture] =
        textures_.try_emplace({ref.image, sampler->second}, static_cast<int>(textures_.size()));
    if (new_texture) root_["textures"].push_back({{"sampler", sampler->second}, {"source", ref.image}});

    Json info{{"index", texture->second}};
    if (ref.texcoord != 0) info["texCoord"] = ref.texcoord;
    if (ref.offset != glm::vec2(0.0f) || ref.scale != glm::vec2(1.0f) || ref.rotation != 0.0f) {
        use("KHR_texture_transform");
        info["extensions"]["KHR_texture_transform"] = {{"offset", {ref.offset.x, ref.offset.y}},
                                                       {"rotation", ref.rotation},
                                                       {"scale", {ref.scale.x, ref.scale.y}}};
    }
    return info;
}

// Only what differs from a material without the extension is written.
void Writer::material_extensions(const Material& m, Json& out) {
    const auto color = [](const glm::vec3& c) { return Json{c.x, c.y, c.z}; };
    const auto put = [&](const char* extension, Json value) {
        use(extension);
        out["extensions"][extension] = std::move(value);
    };
    const auto put_texture = [&](Json& json, const char* key, const TextureRef& ref) {
        if (ref.image != kNone) json[key] = texture_info(ref);
    };
    if (m.ior != 1.5f) put("KHR_materials_ior", {{"ior", m.ior}});
    if (m.specular != 1.0f || m.specular_color != glm::vec3(1.0f) || m.specular_texture.image != kNone ||
        m.specular_color_texture.image != kNone) {
        Json json{{"specularFactor", m.specular}, {"specularColorFactor", color(m.specular_color)}};
        put_texture(json, "specularTexture", m.specular_texture);
        put_texture(json, "specularColorTexture", m.specular_color_texture);
        put("KHR_materials_specular", std::move(json));
    }
    if (m.clearcoat > 0.0f) {
        Json json{{"clearcoatFactor", m.clearcoat}, {"clearcoatRoughnessFactor", m.clearcoat_roughness}};
        put_texture(json, "clearcoatTexture", m.clearcoat_texture);
        put_texture(json, "clearcoatRoughnessTexture", m.clearcoat_roughness_texture);
        put_texture(json, "clearcoatNormalTexture", m.clearcoat_normal_texture);
        if (m.clearcoat_normal_texture.image != kNone)
            json["clearcoatNormalTexture"]["scale"] = m.clearcoat_normal_scale;
        put("KHR_materials_clearcoat", std::move(json));
    }
    if (m.sheen_color != glm::vec3(0.0f)) {
        Json json{{"sheenColorFactor", color(m.sheen_color)}, {"sheenRoughnessFactor", m.sheen_roughness}};
        put_texture(json, "sheenColorTexture", m.sheen_color_texture);
        put_texture(json, "sheenRoughnessTexture", m.sheen_roughness_texture);
        put("KHR_materials_sheen", std::move(json));
    }
    if (m.transmission > 0.0f) {
        Json json{{"transmissionFactor", m.transmission}};
        put_texture(json, "transmissionTexture", m.transmission_texture);
        put("KHR_materials_transmission", std::move(json));
    }
}

void Writer::materials() {
    for (const Material& m : scene_.materials) {
        Json out{{"name", m.name}};
        Json& pbr = out["pbrMetallicRoughness"];
        pbr["baseColorFactor"] = {m.base_color.x, m.base_color.y, m.base_color.z, m.base_color.w};
        pbr["metallicFactor"] = m.metallic;
        pbr["roughnessFactor"] = m.roughness;
        if (m.base_color_texture.image != kNone) pbr["baseColorTexture"] = texture_info(m.base_color_texture);
        if (m.metallic_roughness_texture.image != kNone)
            pbr["metallicRoughnessTexture"] = texture_info(m.metallic_roughness_texture);
        if (m.normal_texture.image != kNone) {
            out["normalTexture"] = texture_info(m.normal_texture);
            out["normalTexture"]["scale"] = m.normal_scale;
        }
        if (m.occlusion_texture.image != kNone) {
            out["occlusionTexture"] = texture_info(m.occlusion_texture);
            out["occlusionTexture"]["strength"] = m.occlusion_strength;
        }
        if (m.emissive_texture.image != kNone) out["emissiveTexture"] = texture_info(m.emissive_texture);
        if (m.emissive != glm::vec3(0.0f)) {
            // A factor may not exceed 1. A power of two as strength keeps the product exact.
            const float most = std::max({m.emissive.x, m.emissive.y, m.emissive.z});
            const float strength = most > 1.0f ? std::exp2(std::ceil(std::log2(most))) : 1.0f;
            const glm::vec3 factor = m.emissive / strength;
            out["emissiveFactor"] = {factor.x, factor.y, factor.z};
            if (strength != 1.0f) {
                use("KHR_materials_emissive_strength");
                out["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = strength;
            }
        }
        if (m.alpha_mode == AlphaMode::kBlend) out["alphaMode"] = "BLEND";
        if (m.alpha_mode == AlphaMode::kMask) {
            out["alphaMode"] = "MASK";
            out["alphaCutoff"] = m.alpha_cutoff;
        }
        if (m.double_sided) out["doubleSided"] = true;
        if (m.unlit) {
            use("KHR_materials_unlit");
            out["extensions"]["KHR_materials_unlit"] = Json::object();
        }
        material_extensions(m, out);
        root_["materials"].push_back(std::move(out));
    }
}

Json Writer::primitive(const Primitive& p) {
    Json attributes;
    attributes["POSITION"] = add_vectors(p.positions, true);
    attributes["NORMAL"] = add_vectors(p.normals);
    if (!p.tangents.empty()) attributes["TANGENT"] = add_vectors(p.tangents);
    for (std::size_t set = 0; set < p.texcoords.size(); ++set)
        if (!p.texcoords[set].empty()) attributes[fmt::format("TEXCOORD_{}", set)] = add_vectors(p.texcoords[set]);
    if (!p.colors.empty()) attributes["COLOR_0"] = add_vectors(p.colors);
    for (int set = 0; 4 * set < p.influences; ++set) {
        std::vector<std::uint16_t> joints;
        std::vector<glm::vec4> weights;
        for (std::size_t i = std::size_t(4 * set); i < p.joints.size(); i += std::size_t(p.influences)) {
            joints.insert(joints.end(), p.joints.begin() + std::ptrdiff_t(i), p.joints.begin() + std::ptrdiff_t(i + 4));
            weights.emplace_back(glm::make_vec4(&p.weights[i]));
        }
        attributes[fmt::format("JOINTS_{}", set)] =
            add_accessor(joints.data(), p.positions.size(), 8, kUnsignedShort, "VEC4", kArrayBuffer);
        attributes[fmt::format("WEIGHTS_{}", set)] = add_vectors(weights);
    }

    Json out{{"attributes", attributes}, {"indices", add_indices(p.indices)}};
    if (p.material != kNone) out["material"] = p.material;
    for (const MorphTarget& t : p.targets) {
        Json target = Json::object();
        if (!t.positions.empty()) target["POSITION"] = add_vectors(t.positions, true);
        if (!t.normals.empty()) target["NORMAL"] = add_vectors(t.normals);
        if (!t.tangents.empty()) target["TANGENT"] = add_vectors(t.tangents);
        out["targets"].push_back(std::move(target));
    }
    return out;
}

void Writer::meshes() {
    for (const Mesh& mesh : scene_.meshes) {
        Json out{{"name", mesh.name}};
        for (const Primitive& p : mesh.primitives)
            if (!p.indices.empty()) out["primitives"].push_back(primitive(p));
        if (!out.contains("primitives"))
            throw Error(ErrorKind::kOutput, fmt::format("mesh '{}' of {}: has no triangles, which glTF does not allow",
                                                        mesh.name, scene_.name));
        if (!mesh.weights.empty()) out["weights"] = mesh.weights;
        root_["meshes"].push_back(std::move(out));
    }
}

void Writer::skins() {
    for (const Skin& skin : scene_.skins) {
        std::vector<float> matrices;
        for (const glm::mat4& m : skin.inverse_bind_matrices)
            matrices.insert(matrices.end(), glm::value_ptr(m), glm::value_ptr(m) + 16);
        const int accessor =
            add_accessor(matrices.data(), skin.inverse_bind_matrices.size(), 64, kFloat, "MAT4", kNoTarget);
        root_["skins"].push_back({{"name", skin.name}, {"inverseBindMatrices", accessor}, {"joints", skin.joints}});
    }
}

Json lens_extras(const LensInfo& lens) {
    Json extras = Json::object();
    const auto put = [&](const char* key, const auto& value) {
        if (value) extras[key] = *value;
    };
    put("fstop", lens.fstop);
    put("focusDistance", lens.focus_distance);
    put("focalLength", lens.focal_length_mm);
    put("sensorWidth", lens.sensor_width_mm);
    put("shutter", lens.shutter);
    put("apertureBlades", lens.aperture_blades);
    put("apertureRotation", lens.aperture_rotation_deg);
    put("apertureRatio", lens.aperture_ratio);
    put("focusRange", lens.focus_range);
    put("maxForegroundBlur", lens.max_foreground_blur);
    put("tilt", lens.tilt_deg);
    put("swing", lens.swing_deg);
    put("catsEye", lens.cats_eye);
    return extras;
}

void Writer::cameras() {
    for (const Camera& camera : scene_.cameras) {
        Json out{{"name", camera.name}, {"type", camera.perspective ? "perspective" : "orthographic"}};
        Json& shape = out[camera.perspective ? "perspective" : "orthographic"];
        if (camera.perspective) {
            shape["yfov"] = camera.yfov;
            if (camera.aspect) shape["aspectRatio"] = *camera.aspect;
        } else {
            shape["xmag"] = camera.xmag;
            shape["ymag"] = camera.ymag;
        }
        shape["znear"] = camera.znear;
        if (std::isfinite(camera.zfar)) shape["zfar"] = camera.zfar;
        const Json extras = lens_extras(camera.lens);
        if (!extras.empty()) out["extras"] = extras;
        root_["cameras"].push_back(std::move(out));
    }
}

void Writer::lights() {
    if (scene_.lights.empty()) return;
    use("KHR_lights_punctual");
    Json& list = root_["extensions"]["KHR_lights_punctual"]["lights"];
    for (const Light& light : scene_.lights) {
        const char* type = light.kind == LightKind::kDirectional ? "directional"
                           : light.kind == LightKind::kSpot      ? "spot"
                                                                 : "point";
        Json out{{"name", light.name},
                 {"type", type},
                 {"color", json(glm::dvec3(light.color))},
                 {"intensity", light.intensity}};
        if (std::isfinite(light.range) && light.kind != LightKind::kDirectional) out["range"] = light.range;
        if (light.kind == LightKind::kSpot)
            out["spot"] = {{"innerConeAngle", light.inner_cone}, {"outerConeAngle", light.outer_cone}};
        list.push_back(std::move(out));
    }
}

Json Writer::instancing(const std::vector<Transform>& instances) {
    use("EXT_mesh_gpu_instancing");
    std::vector<glm::vec3> translations, scales;
    std::vector<glm::vec4> rotations;
    for (const Transform& t : instances) {
        translations.emplace_back(t.translation);
        rotations.emplace_back(t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w);
        scales.emplace_back(t.scale);
    }
    Json out;
    out["attributes"]["TRANSLATION"] = add_vectors(translations);
    out["attributes"]["ROTATION"] = add_vectors(rotations);
    out["attributes"]["SCALE"] = add_vectors(scales);
    return out;
}

void Writer::nodes() {
    for (const Node& node : scene_.nodes) {
        Json out{{"name", node.name}};
        const Transform& t = node.transform;
        if (node.matrix) {
            out["matrix"] = std::vector<double>(glm::value_ptr(*node.matrix), glm::value_ptr(*node.matrix) + 16);
        } else {
            if (t.translation != glm::dvec3(0.0)) out["translation"] = json(t.translation);
            if (t.rotation != glm::dquat(1.0, 0.0, 0.0, 0.0)) out["rotation"] = json(t.rotation);
            if (t.scale != glm::dvec3(1.0)) out["scale"] = json(t.scale);
        }
        if (!node.children.empty()) out["children"] = node.children;
        if (node.mesh != kNone) out["mesh"] = node.mesh;
        if (node.skin != kNone) out["skin"] = node.skin;
        if (node.camera != kNone) out["camera"] = node.camera;
        if (!node.weights.empty()) out["weights"] = node.weights;
        if (node.light != kNone) out["extensions"]["KHR_lights_punctual"]["light"] = node.light;
        if (!node.instances.empty()) out["extensions"]["EXT_mesh_gpu_instancing"] = instancing(node.instances);
        root_["nodes"].push_back(std::move(out));
    }
}

Json target_of(const Channel& channel) {
    constexpr std::array kPaths{"translation",          "rotation",    "scale", "weights", "perspective/yfov",
                                "extras/focusDistance", "extras/fstop"};
    const char* path = kPaths[std::size_t(channel.path)];
    if (channel.camera == kNone) return {{"node", channel.node}, {"path", path}};
    Json target{{"path", "pointer"}};
    target["extensions"]["KHR_animation_pointer"]["pointer"] = fmt::format("/cameras/{}/{}", channel.camera, path);
    return target;
}

void Writer::animations() {
    constexpr std::array kInterpolations{"STEP", "LINEAR", "CUBICSPLINE"};
    for (const Animation& animation : scene_.animations) {
        if (animation.channels.empty()) continue;
        Json channels, samplers;
        for (const Channel& channel : animation.channels) {
            const auto [times, is_new] = key_times_.try_emplace(channel.times, 0);
            if (is_new) times->second = add_floats(channel.times, 1, true);
            // Weights are a list of single numbers, however many there are for each key.
            const int width = channel.path == ChannelPath::kWeights ? 1 : channel.width;
            const int values = add_floats(channel.values, width, false);
            if (channel.camera != kNone) use("KHR_animation_pointer");
            channels.push_back({{"sampler", samplers.size()}, {"target", target_of(channel)}});
            samplers.push_back({{"input", times->second},
                                {"interpolation", kInterpolations[std::size_t(channel.interpolation)]},
                                {"output", values}});
        }
        root_["animations"].push_back({{"name", animation.name}, {"channels", channels}, {"samplers", samplers}});
    }
}

void append_chunk(std::string& file, const char (&type)[5], std::string_view data, char padding) {
    const std::size_t length = (data.size() + 3) / 4 * 4;
    for (int i = 0; i < 4; ++i) file.push_back(static_cast<char>(length >> (8 * i)));
    file.append(type, 4);
    file.append(data);
    file.append(length - data.size(), padding);
}

std::string Writer::document() {
    root_["asset"] = {{"version", "2.0"}, {"generator", "pentaprism"}};
    root_["scene"] = 0;
    root_["scenes"].push_back({{"name", scene_.name}, {"nodes", scene_.roots}});
    if (const auto& color = scene_.background)  // glTF itself has none
        root_["scenes"][0]["extras"] = {{"background", {color->r, color->g, color->b}}};
    nodes();
    cameras();
    meshes();
    skins();
    materials();
    images();
    lights();
    animations();
    if (!extensions_.empty()) root_["extensionsUsed"] = extensions_;
    if (extensions_.contains("EXT_mesh_gpu_instancing")) root_["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    if (!binary_.empty()) root_["buffers"].push_back({{"byteLength", binary_.size()}});

    std::string chunks;
    append_chunk(chunks, "JSON", root_.dump(-1, ' ', false, Json::error_handler_t::replace), ' ');
    if (!binary_.empty()) append_chunk(chunks, "BIN\0", {binary_.data(), binary_.size()}, '\0');
    const std::size_t total = 12 + chunks.size();
    if (total > 0xffffffffu)
        throw Error(ErrorKind::kOutput, fmt::format("{}: over 4 GiB, which a .glb cannot hold", scene_.name));
    std::string file = "glTF";
    for (const std::size_t word : {std::size_t(2), total})
        for (int i = 0; i < 4; ++i) file.push_back(static_cast<char>(word >> (8 * i)));
    return file + chunks;
}

}  // namespace

void write_glb(const Scene& scene, const std::filesystem::path& file) {
    const std::string bytes = Writer(scene).document();
    PartFile part(file);
    part.write(bytes.data(), bytes.size());
    part.commit();
}

}  // namespace pentaprism
