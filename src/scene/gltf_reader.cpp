#include "scene/gltf_reader.h"

#include <fmt/format.h>
#include <new>
#include <pentaprism/error.h>
#include <stdexcept>

#include "scene/gltf_parts.h"

namespace pentaprism {

namespace {

void check_asset(gltf::Document& document) {
    const gltf::Object asset = document.root().child("asset");
    const std::string version = asset.text("version");
    if (!version.starts_with("2."))
        document.fail(fmt::format("is glTF version \"{}\"; only 2.0 is supported", version));
    const std::string least = asset.text("minVersion", "2.0");
    if (least != "2.0")
        document.fail(fmt::format("asks for glTF version \"{}\" at least; only 2.0 is supported", least));
}

Scene read_scene(gltf::Document& document) {
    gltf::check_types(document);
    check_asset(document);
    gltf::check_extensions(document);
    gltf::read_buffers(document);
    gltf::check_accessors(document);

    Scene scene;
    scene.name = document.name;
    gltf::read_images(document, scene);
    gltf::read_materials(document, scene);
    gltf::read_meshes(document, scene);
    gltf::read_cameras(document, scene);
    gltf::read_lights(document, scene);
    gltf::read_nodes(document, scene);
    gltf::check_lenses(document, scene);
    gltf::read_skins(document, scene);
    gltf::read_roots(document, scene);
    gltf::read_animations(document, scene);
    return scene;
}

}  // namespace

Scene load_gltf(const std::filesystem::path& file) {
    gltf::Document document;
    try {
        gltf::read_container(file, document);
        Scene scene = read_scene(document);
        scene.warnings = std::move(document.warnings);
        return scene;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::kScene, file.filename().string() + ": needs more memory than there is");
    } catch (const std::length_error&) {
        throw Error(ErrorKind::kScene, file.filename().string() + ": needs more memory than there is");
    } catch (const nlohmann::json::exception& problem) {
        throw Error(ErrorKind::kScene,
                    file.filename().string() + ": the JSON is not that of a glTF: " + problem.what());
    }
}

}  // namespace pentaprism
