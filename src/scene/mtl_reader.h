#pragma once
// MTL material libraries of OBJ files.

#include <filesystem>
#include <map>
#include <pentaprism/scene.h>
#include <string>

namespace pentaprism {

/// Material name to index into Scene::materials.
using MaterialNames = std::map<std::string, Index>;

/// Adds the library's materials and their textures to the scene. A missing library or texture is a warning.
void read_mtl(const std::filesystem::path& file, Scene& scene, MaterialNames& names);

}  // namespace pentaprism
