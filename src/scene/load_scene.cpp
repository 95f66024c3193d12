// One door for all kinds of scenes.

#include <algorithm>
#include <cctype>
#include <pentaprism/error.h>
#include <pentaprism/scene.h>

#include "scene/gltf_reader.h"
#include "scene/obj_reader.h"
#include "scene/pose.h"

namespace pentaprism {

namespace {

constexpr std::string_view kBuiltinPrefix = "builtin:";

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

}  // namespace

Scene load_scene(const std::string& source) {
    if (source.starts_with(kBuiltinPrefix))
        return make_builtin_scene(std::string_view(source).substr(kBuiltinPrefix.size()));
    const std::filesystem::path file(source);
    const std::string suffix = lower_case(file.extension().string());
    if (suffix == ".gltf" || suffix == ".glb") return load_gltf(file);
    if (suffix == ".obj") return load_obj(file);
    throw Error(ErrorKind::kScene, source + ": not a scene: give a .gltf, .glb or .obj file or builtin:NAME");
}

std::int64_t count_triangles(const Scene& scene) {
    std::int64_t count = 0;
    for (const Placement& placement : placements(scene)) {
        const Mesh& mesh = scene.meshes[static_cast<std::size_t>(placement.mesh)];
        count += static_cast<std::int64_t>(
            mesh.primitives[static_cast<std::size_t>(placement.primitive)].indices.size() / 3);
    }
    return count;
}

}  // namespace pentaprism
