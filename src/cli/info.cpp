// `pentaprism info SCENE`: what is in a scene.

#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <pentaprism/metadata.h>
#include <pentaprism/scene.h>

#include "cli/commands.h"
#include "cli/messages.h"
#include "cli/options.h"

namespace pentaprism::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMegabyte = 1024.0 * 1024.0;

template <class T>
std::size_t bytes_of(const std::vector<T>& values) {
    return values.size() * sizeof(T);
}

std::size_t bytes_of(const Primitive& p) {
    std::size_t bytes = bytes_of(p.positions) + bytes_of(p.normals) + bytes_of(p.tangents) + bytes_of(p.texcoords[0]) +
                        bytes_of(p.texcoords[1]) + bytes_of(p.colors) + bytes_of(p.joints) + bytes_of(p.weights) +
                        bytes_of(p.indices);
    for (const MorphTarget& target : p.targets) {
        bytes += bytes_of(target.positions) + bytes_of(target.normals) + bytes_of(target.tangents);
    }
    return bytes;
}

struct MeshCounts {
    std::size_t primitives = 0, vertices = 0, stored_triangles = 0, morph_targets = 0, bytes = 0;
};

MeshCounts count_meshes(const Scene& scene) {
    MeshCounts counts;
    for (const Mesh& mesh : scene.meshes) {
        std::size_t targets = 0;
        for (const Primitive& primitive : mesh.primitives) {
            ++counts.primitives;
            counts.vertices += primitive.positions.size();
            counts.stored_triangles += primitive.indices.size() / 3;
            counts.bytes += bytes_of(primitive);
            targets = std::max(targets, primitive.targets.size());
        }
        counts.morph_targets += targets;
    }
    return counts;
}

std::size_t animation_bytes(const Scene& scene) {
    std::size_t bytes = 0;
    for (const Animation& animation : scene.animations) {
        for (const Channel& channel : animation.channels) bytes += bytes_of(channel.times) + bytes_of(channel.values);
    }
    return bytes;
}

template <class T>
void put(Json& json, const char* key, const std::optional<T>& value) {
    if (value) json[key] = *value;
}

Json lens_json(const LensInfo& lens) {
    Json json = Json::object();
    put(json, "fstop", lens.fstop);
    put(json, "focus_distance", lens.focus_distance);
    put(json, "focal_length_mm", lens.focal_length_mm);
    put(json, "sensor_width_mm", lens.sensor_width_mm);
    put(json, "shutter", lens.shutter);
    put(json, "aperture_blades", lens.aperture_blades);
    put(json, "aperture_rotation_deg", lens.aperture_rotation_deg);
    put(json, "aperture_ratio", lens.aperture_ratio);
    put(json, "focus_range", lens.focus_range);
    put(json, "max_foreground_blur", lens.max_foreground_blur);
    put(json, "tilt_deg", lens.tilt_deg);
    put(json, "swing_deg", lens.swing_deg);
    put(json, "cats_eye", lens.cats_eye);
    return json;
}

/// A camera or light is placed by the nodes that name it.
template <class Member>
Json nodes_with(const Scene& scene, Member member, Index index) {
    Json names = Json::array();
    for (const Node& node : scene.nodes) {
        if (node.*member == index) names.push_back(node.name);
    }
    return names;
}

Json cameras_json(const Scene& scene) {
    Json list = Json::array();
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        const Camera& camera = scene.cameras[i];
        Json json{
            {"index", i}, {"name", camera.name}, {"nodes", nodes_with(scene, &Node::camera, static_cast<Index>(i))}};
        json["kind"] = camera.perspective ? "perspective" : "orthographic";
        if (camera.perspective) {
            json["yfov_deg"] = camera.yfov * 180.0 / std::numbers::pi;
        } else {
            json["width_m"] = 2.0 * camera.xmag;
            json["height_m"] = 2.0 * camera.ymag;
        }
        json["lens"] = lens_json(camera.lens);
        list.push_back(std::move(json));
    }
    return list;
}

Json lights_json(const Scene& scene) {
    Json list = Json::array();
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        const Light& light = scene.lights[i];
        const char* kind = light.kind == LightKind::kDirectional ? "directional"
                           : light.kind == LightKind::kPoint     ? "point"
                                                                 : "spot";
        list.push_back({{"index", i},
                        {"name", light.name},
                        {"nodes", nodes_with(scene, &Node::light, static_cast<Index>(i))},
                        {"kind", kind},
                        {"intensity", light.intensity},
                        {"color", {light.color.r, light.color.g, light.color.b}}});
    }
    return list;
}

Json animations_json(const Scene& scene) {
    Json list = Json::array();
    for (std::size_t i = 0; i < scene.animations.size(); ++i) {
        const Animation& animation = scene.animations[i];
        list.push_back({{"index", i},
                        {"name", animation.name},
                        {"seconds", animation.duration},
                        {"channels", animation.channels.size()}});
    }
    return list;
}

Json textures_json(const Scene& scene) {
    Json list = Json::array();
    for (const Image& image : scene.images) {
        list.push_back({{"name", image.name},
                        {"width", image.width},
                        {"height", image.height},
                        {"mb", static_cast<double>(image.texels.size()) / kMegabyte}});
    }
    return list;
}

Json memory_json(const Scene& scene, std::size_t mesh_bytes, std::int64_t triangles) {
    std::size_t texels = 0;
    for (const Image& image : scene.images) texels += image.texels.size();
    const double meshes = static_cast<double>(mesh_bytes) / kMegabyte;
    const double textures = static_cast<double>(texels) / kMegabyte;
    const double animations = static_cast<double>(animation_bytes(scene)) / kMegabyte;
    // Mip levels add a third. A triangle of a frame: two knots of three clip-space vertices, setup, bounds, normals,
    // bin entries.
    constexpr double kBytesPerTriangle = 400.0;
    const double frame = static_cast<double>(triangles) * kBytesPerTriangle / kMegabyte;
    return {{"meshes", meshes},
            {"textures", textures},
            {"animations", animations},
            {"render_estimate", meshes + textures * 7.0 / 3.0 + animations + frame}};
}

Json describe(const Scene& scene, const std::string& source) {
    const MeshCounts counts = count_meshes(scene);
    std::size_t joints = 0;
    for (const Skin& skin : scene.skins) joints += skin.joints.size();
    std::size_t instances = 0;
    for (const Node& node : scene.nodes) instances += node.instances.size();
    Json json;
    json["scene"] = scene.name;
    json["scene_hash"] = scene_hash(source);
    json["triangles"] = count_triangles(scene);
    json["stored_triangles"] = counts.stored_triangles;
    json["vertices"] = counts.vertices;
    json["meshes"] = scene.meshes.size();
    json["primitives"] = counts.primitives;
    json["nodes"] = scene.nodes.size();
    json["instances"] = instances;
    json["materials"] = scene.materials.size();
    json["skins"] = scene.skins.size();
    json["joints"] = joints;
    json["morph_targets"] = counts.morph_targets;
    json["cameras"] = cameras_json(scene);
    json["lights"] = lights_json(scene);
    json["animations"] = animations_json(scene);
    json["textures"] = textures_json(scene);
    json["memory_mb"] = memory_json(scene, counts.bytes, json["triangles"].get<std::int64_t>());
    json["warnings"] = scene.warnings;
    return json;
}

std::string quoted(const Json& name) {
    const std::string text = name.get<std::string>();
    return text.empty() ? "(no name)" : "'" + one_line(text) + "'";
}

std::string lens_text(const Json& lens) {
    std::string text;
    for (const auto& [key, value] : lens.items())
        text += value.is_number()
                    ? fmt::format(", {} {:.6g}", key, value.get<double>())
                    : fmt::format(", {} {:.6g} to {:.6g}", key, value[0].get<double>(), value[1].get<double>());
    return text;
}

std::string to_text(const Json& info) {
    std::string text = fmt::format("{}\n", one_line(info["scene"].get<std::string>()));
    const auto line = [&](const char* label, const std::string& value) {
        text += fmt::format("  {:<12} {}\n", label, value);
    };
    const auto number = [&](const char* key) { return info[key].get<std::int64_t>(); };
    line("triangles", fmt::format("{} ({} stored, {} vertices)", number("triangles"), number("stored_triangles"),
                                  number("vertices")));
    line("meshes", fmt::format("{} with {} primitives, {} materials", number("meshes"), number("primitives"),
                               number("materials")));
    line("nodes", fmt::format("{}, {} instances", number("nodes"), number("instances")));
    line("skins", fmt::format("{} with {} joints, {} morph targets", number("skins"), number("joints"),
                              number("morph_targets")));
    if (info["cameras"].empty()) line("cameras", "0 (one that frames the scene is used)");
    for (const Json& camera : info["cameras"]) {
        const std::string view =
            camera.contains("yfov_deg")
                ? fmt::format("{:.4g} degrees high", camera["yfov_deg"].get<double>())
                : fmt::format("{:.4g} x {:.4g} m", camera["width_m"].get<double>(), camera["height_m"].get<double>());
        line("camera", fmt::format("{} {}: {}, {}{}", camera["index"].get<int>(), quoted(camera["name"]),
                                   camera["kind"].get<std::string>(), view, lens_text(camera["lens"])));
    }
    for (const Json& light : info["lights"]) {
        line("light", fmt::format("{} {}: {}, intensity {:.4g}", light["index"].get<int>(), quoted(light["name"]),
                                  light["kind"].get<std::string>(), light["intensity"].get<double>()));
    }
    for (const Json& animation : info["animations"]) {
        line("animation",
             fmt::format("{} {}: {:.3f} s, {} channels", animation["index"].get<int>(), quoted(animation["name"]),
                         animation["seconds"].get<double>(), animation["channels"].get<int>()));
    }
    for (const Json& texture : info["textures"]) {
        line("texture", fmt::format("{}: {}x{}, {:.1f} MB", quoted(texture["name"]), texture["width"].get<int>(),
                                    texture["height"].get<int>(), texture["mb"].get<double>()));
    }
    const Json& memory = info["memory_mb"];
    line("memory", fmt::format("{:.1f} MB meshes, {:.1f} MB textures, {:.1f} MB animation; about {:.0f} MB to render",
                               memory["meshes"].get<double>(), memory["textures"].get<double>(),
                               memory["animations"].get<double>(), memory["render_estimate"].get<double>()));
    for (const Json& warning : info["warnings"]) line("warning", one_line(warning.get<std::string>()));
    return text;
}

}  // namespace

void add_info(CLI::App& program, Run& run) {
    struct State {
        std::string scene;
        bool json = false;
    };
    CLI::App* command = program.add_subcommand("info", "Tell what is in a scene");
    const auto state = std::make_shared<State>();
    add_scene_argument(*command, state->scene);
    command->add_flag("--json", state->json, "One JSON document on stdout");
    command->callback([state, &run] {
        run = [state] {
            const Json info = describe(load_scene(state->scene), state->scene);
            print_result(state->json ? info.dump(2, ' ', false, Json::error_handler_t::replace) + "\n" : to_text(info));
            return 0;
        };
    });
}

}  // namespace pentaprism::cli
