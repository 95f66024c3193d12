// Animations (glTF 2.0, 3.11), and of KHR_animation_pointer
// (https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Khronos/KHR_animation_pointer) what moves nodes and
// cameras: a field of view, a focus distance, an f-number.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <set>
#include <string_view>
#include <tuple>

#include "scene/gltf_parts.h"

namespace pentaprism::gltf {

namespace {

constexpr int kFloat = 5126;

std::optional<ChannelPath> channel_path(const std::string& path) {
    if (path == "translation") return ChannelPath::kTranslation;
    if (path == "rotation") return ChannelPath::kRotation;
    if (path == "scale") return ChannelPath::kScale;
    if (path == "weights") return ChannelPath::kWeights;
    return std::nullopt;
}

Interpolation sampler_interpolation(const Object& sampler) {
    const std::string name = sampler.text("interpolation", "LINEAR");
    if (name == "STEP") return Interpolation::kStep;
    if (name == "LINEAR") return Interpolation::kLinear;
    if (name == "CUBICSPLINE") return Interpolation::kCubicSpline;
    sampler.fail(fmt::format("has an unknown interpolation \"{}\"", name));
}

void read_times(Document& document, const Object& sampler, std::vector<float>& times) {
    const Index input = sampler.index("input", "accessors");
    require_type(document, input, {"SCALAR"}, sampler.where() + ", input,");
    if (describe_accessor(document, input).component_type != kFloat) sampler.fail("has times that are not floats");
    times = read_floats(document, input);
    if (!all_finite(times)) sampler.fail("has a time that is not finite");
    if (!std::is_sorted(times.begin(), times.end())) sampler.fail("has times that do not ascend");
    if (times.front() < 0.0f) document.warn(sampler.where() + " has times below 0");
}

void read_values(Document& document, const Object& sampler, Channel& channel) {
    const Index output = sampler.index("output", "accessors");
    const char* const type = channel.path == ChannelPath::kWeights    ? "SCALAR"
                             : channel.camera != kNone                ? "SCALAR"
                             : channel.path == ChannelPath::kRotation ? "VEC4"
                                                                      : "VEC3";
    require_type(document, output, {type}, sampler.where() + ", output,");
    channel.values = read_floats(document, output);
    if (!all_finite(channel.values)) sampler.fail("has a value that is not finite");
    const std::size_t for_each_key =
        static_cast<std::size_t>(channel.width) * (channel.interpolation == Interpolation::kCubicSpline ? 3 : 1);
    if (channel.values.size() != channel.times.size() * for_each_key) {
        sampler.fail(fmt::format("has {} numbers for {} keys, which take {} each", channel.values.size(),
                                 channel.times.size(), for_each_key));
    }
}

/// Keys of rotations as unit quaternions. Those of cubic splines are left alone: the result is normalised, not the
/// keys.
void normalise_rotations(Document& document, const Object& sampler, Channel& channel) {
    if (channel.path != ChannelPath::kRotation || channel.interpolation == Interpolation::kCubicSpline) return;
    for (std::size_t i = 0; i < channel.values.size(); i += 4) {
        float* q = &channel.values[i];
        const double length =
            std::sqrt(double(q[0]) * q[0] + double(q[1]) * q[1] + double(q[2]) * q[2] + double(q[3]) * q[3]);
        if (!(std::abs(length - 1.0) < 0.01))
            document.warn(sampler.where() + " has rotations that are not unit quaternions; they are scaled");
        if (!(length > 0.0)) q[3] = 1.0f;
        for (int k = 0; k < 4 && length > 0.0; ++k) q[k] = static_cast<float>(q[k] / length);
    }
}

/// "/LIST/INDEX/PROPERTY" with an index below `count`: what is left of it, and the index.
std::optional<std::pair<Index, std::string_view>> item_of(std::string_view pointer, std::string_view list,
                                                          std::size_t count) {
    if (pointer.substr(0, list.size()) != list) return std::nullopt;
    pointer.remove_prefix(list.size());
    std::size_t index = 0;
    const auto [end, problem] = std::from_chars(pointer.data(), pointer.data() + pointer.size(), index);
    const auto digits = static_cast<std::size_t>(end - pointer.data());
    if (problem != std::errc() || index >= count || digits >= pointer.size() || pointer[digits] != '/')
        return std::nullopt;
    return std::pair(static_cast<Index>(index), pointer.substr(digits + 1));
}

/// What a pointer moves: a camera's property, or (true) a node's, whose name is left in `path`. `copies`: of that
/// camera, which move with it.
bool read_pointer(const Document& document, const Scene& scene, std::string_view pointer, Channel& channel,
                  std::string& path, std::vector<Index>& copies) {
    constexpr std::string_view kFocus = "extras/focusDistance", kFstop = "extras/fstop";
    const auto camera = item_of(pointer, "/cameras/", document.count("cameras"));
    const auto node = item_of(pointer, "/nodes/", scene.nodes.size());
    const std::string_view property = camera ? camera->second : node ? node->second : "";
    if (property == kFocus || (camera && property == "extensions/EXT_cameras_sensor/lens/focusDistance"))
        channel.path = ChannelPath::kFocusDistance;
    else if (property == kFstop)
        channel.path = ChannelPath::kFstop;
    else if (camera && property == "perspective/yfov")
        channel.path = ChannelPath::kYfov;
    else if (node) {
        channel.node = node->first;
        path = property;
        return true;
    } else
        return false;
    channel.camera = camera ? camera->first : scene.nodes[static_cast<std::size_t>(node->first)].camera;
    channel.width = 1;
    for (std::size_t i = document.count("cameras"); camera && i < scene.cameras.size(); ++i)
        if (document.original_cameras[i] == channel.camera) copies.push_back(static_cast<Index>(i));
    return false;
}

/// False: the channel moves nothing that is shown, for a reason that was given as a warning.
bool read_target(Document& document, const Scene& scene, const Object& object, Channel& channel,
                 std::vector<Index>& copies) {
    const Object target = object.child("target");
    channel.node = target.index("node", "nodes");
    if (!target.has("path")) target.fail("has no path");
    std::string path = target.text("path");
    if (path == "pointer" && target.has_extension("KHR_animation_pointer")) {
        const std::string pointer = target.extension("KHR_animation_pointer").text("pointer");
        if (!read_pointer(document, scene, pointer, channel, path, copies)) {
            if (channel.camera == kNone)
                document.warn(fmt::format("{} moves {}, which is not supported; it does not move", target.where(),
                                          pointer.empty() ? "nothing" : pointer));
            return channel.camera != kNone;
        }
    }
    const auto known = channel_path(path);
    if (!known) {
        document.warn(
            fmt::format("{} has the path \"{}\", which is not supported; it does not move", target.where(), path));
        return false;
    }
    channel.path = *known;
    if (channel.node == kNone) return false;
    const Node& node = scene.nodes[static_cast<std::size_t>(channel.node)];
    if (channel.path == ChannelPath::kWeights) {
        channel.width =
            node.mesh == kNone ? 0 : static_cast<int>(scene.meshes[static_cast<std::size_t>(node.mesh)].weights.size());
        if (channel.width == 0)
            document.warn(fmt::format("{} animates weights of node {}, which has no morph targets", target.where(),
                                      channel.node));
        return channel.width != 0;
    }
    channel.width = channel.path == ChannelPath::kRotation ? 4 : 3;
    if (node.matrix) {
        document.warn(
            fmt::format("{} animates node {}, which has a matrix; it does not move", target.where(), channel.node));
        return false;
    }
    return true;
}

Animation read_animation(Document& document, const Scene& scene, const Object& object) {
    Animation animation;
    animation.name = object.text("name");
    const auto samplers = object.children("samplers", "sampler");
    std::vector<std::vector<float>> times(samplers.size());
    for (std::size_t i = 0; i < samplers.size(); ++i) {
        const Object& sampler = samplers[i];
        if (!sampler.has("input") || !sampler.has("output")) sampler.fail("has no input or output");
        sampler.index("input", "accessors");
        sampler.index("output", "accessors");
        sampler_interpolation(sampler);
        read_times(document, sampler, times[i]);
    }
    const auto channels = object.children("channels", "channel");
    if (channels.empty()) object.fail("has no channels");
    std::set<std::tuple<Index, Index, ChannelPath>> targets;
    for (const Object& part : channels) {
        const std::size_t index = part.required_size("sampler");
        if (index >= samplers.size())
            part.fail(fmt::format("refers to sampler {}, but there are {}", index, samplers.size()));
        Channel channel;
        std::vector<Index> copies;
        if (!read_target(document, scene, part, channel, copies)) continue;
        const Object& sampler = samplers[index];
        channel.interpolation = sampler_interpolation(sampler);
        channel.times = times[index];
        read_values(document, sampler, channel);
        normalise_rotations(document, sampler, channel);
        if (!targets.emplace(channel.node, channel.camera, channel.path).second) {
            document.warn(part.where() + " moves what another channel of the clip moves; the first one is used");
            continue;
        }
        animation.duration = std::max(animation.duration, static_cast<double>(channel.times.back()));
        for (const Index copy : copies) {
            if (!targets.emplace(kNone, copy, channel.path).second) continue;
            document.spend(channel.times.size() + channel.values.size());
            animation.channels.push_back(channel);
            animation.channels.back().camera = copy;
        }
        animation.channels.push_back(std::move(channel));
    }
    return animation;
}

}  // namespace

void read_animations(Document& document, Scene& scene) {
    for (std::size_t i = 0; i < document.count("animations"); ++i) {
        scene.animations.push_back(read_animation(document, scene, document.item("animations", "animation", i)));
    }
}

}  // namespace pentaprism::gltf
