// Cameras (glTF 2.0, 3.10) and lights (KHR_lights_punctual,
// https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Khronos/KHR_lights_punctual).

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

#include "scene/gltf_lens.h"
#include "scene/gltf_parts.h"

namespace pentaprism::gltf {

namespace {

/// Radians; at pi the picture plane is infinite.
constexpr double kWidestYfov = 3.1;

double positive(const Object& object, const char* key) {
    if (!object.has(key)) object.fail(fmt::format("has no {}", key));
    const double value = object.number(key, 0.0);
    if (!(value > 0.0)) object.fail(fmt::format("has a {} of {}", key, value));
    return value;
}

void read_perspective(Document& document, const Object& object, Camera& camera) {
    camera.yfov = positive(object, "yfov");
    if (camera.yfov >= glm::pi<double>()) {
        document.warn(fmt::format("{} has a yfov of {}; {} is used", object.where(), camera.yfov, kWidestYfov));
        camera.yfov = kWidestYfov;
    }
    if (object.has("aspectRatio")) camera.aspect = positive(object, "aspectRatio");
    camera.znear = positive(object, "znear");
    if (object.has("zfar")) camera.zfar = positive(object, "zfar");
    if (camera.zfar <= camera.znear)
        document.warn(object.where() + " has a zfar that is not beyond its znear; both are as given");
}

void read_orthographic(Document& document, const Object& object, Camera& camera) {
    camera.perspective = false;
    if (!object.has("xmag") || !object.has("ymag")) object.fail("has no xmag or ymag");
    camera.xmag = object.number("xmag", 1.0);
    camera.ymag = object.number("ymag", 1.0);
    if (camera.xmag == 0.0 || camera.ymag == 0.0) object.fail("has an xmag or ymag of 0");
    if (camera.xmag < 0.0 || camera.ymag < 0.0)
        document.warn(object.where() + " has a negative xmag or ymag; its size is used");
    camera.xmag = std::abs(camera.xmag);
    camera.ymag = std::abs(camera.ymag);
    camera.znear = object.number("znear", 0.0);
    if (!object.has("zfar")) object.fail("has no zfar");
    camera.zfar = object.number("zfar", 0.0);
    if (camera.zfar <= camera.znear)
        document.warn(object.where() + " has a zfar that is not beyond its znear; both are as given");
}

LightKind light_kind(const Object& object) {
    const std::string type = object.text("type");
    if (type == "directional") return LightKind::kDirectional;
    if (type == "point") return LightKind::kPoint;
    if (type == "spot") return LightKind::kSpot;
    object.fail(fmt::format("has an unknown type \"{}\"", type));
}

Light read_light(Document& document, const Object& object) {
    Light light;
    light.name = object.text("name");
    light.kind = light_kind(object);
    if (const auto color = object.numbers("color", 3); !color.empty()) light.color = {color[0], color[1], color[2]};
    light.intensity = static_cast<float>(object.number("intensity", 1.0));
    if (light.intensity < 0.0f) object.fail(fmt::format("has an intensity of {}", light.intensity));
    if (object.has("range")) light.range = static_cast<float>(positive(object, "range"));
    if (light.kind != LightKind::kSpot) return light;
    if (!object.has("spot")) object.fail("has no spot");
    const Object spot = object.child("spot");
    light.inner_cone = static_cast<float>(spot.number("innerConeAngle", 0.0));
    light.outer_cone = static_cast<float>(spot.number("outerConeAngle", glm::quarter_pi<double>()));
    if (light.inner_cone < 0.0f || light.outer_cone > glm::half_pi<float>() || light.inner_cone >= light.outer_cone) {
        document.warn(fmt::format("{} has cone angles {} and {}; 0 <= inner < outer <= pi/2 is used", object.where(),
                                  light.inner_cone, light.outer_cone));
        light.outer_cone = glm::clamp(light.outer_cone, 0.001f, glm::half_pi<float>());
        light.inner_cone = glm::clamp(light.inner_cone, 0.0f, light.outer_cone * 0.999f);
    }
    return light;
}

}  // namespace

void read_cameras(Document& document, Scene& scene) {
    for (std::size_t i = 0; i < document.count("cameras"); ++i) {
        const Object object = document.item("cameras", "camera", i);
        Camera camera;
        camera.name = object.text("name");
        const std::string type = object.text("type");
        if (type == "perspective") {
            read_perspective(document, object.child("perspective"), camera);
        } else if (type == "orthographic") {
            read_orthographic(document, object.child("orthographic"), camera);
        } else {
            object.fail(fmt::format("has an unknown type \"{}\"", type));
        }
        read_lens(document, object, camera.lens);
        scene.cameras.push_back(std::move(camera));
        document.original_cameras.push_back(static_cast<Index>(i));
    }
}

void check_lenses(Document& document, const Scene& scene) {
    for (std::size_t i = 0; i < scene.cameras.size(); ++i)
        if (!scene.cameras[i].perspective && scene.cameras[i].lens.fstop)
            document.warn(
                document.item("cameras", "camera", static_cast<std::size_t>(document.original_cameras[i])).where() +
                " is orthographic, so it has no fstop: it sees sharply without --lens-radius");
}

void read_lights(Document& document, Scene& scene) {
    if (!document.root().has_extension("KHR_lights_punctual")) return;
    for (const Object& object : document.root().extension("KHR_lights_punctual").children("lights", "light")) {
        scene.lights.push_back(read_light(document, object));
    }
}

}  // namespace pentaprism::gltf
