#pragma once
// Wavefront OBJ files with MTL materials.

#include <filesystem>
#include <pentaprism/scene.h>

namespace pentaprism {

/// Reads an `.obj`, the `.mtl` files it names and their textures. Throws Error(kScene) when the file cannot be read or
/// refers to vertices that do not exist; what is missing otherwise is in Scene::warnings.
Scene load_obj(const std::filesystem::path& file);

}  // namespace pentaprism
