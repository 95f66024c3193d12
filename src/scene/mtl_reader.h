#pragma once
// MTL material libraries of OBJ files.

#include <filesystem>
#include <map>
#include <pentaprism/scene.h>
#include <string>
#include <vector>

namespace pentaprism {

/// Material name to index into Scene::materials.
using MaterialNames = std::map<std::string, Index>;

/// The libraries that a line of an OBJ in that folder names; none for a line that is no mtllib. Names may hold spaces:
/// one file if there is one of the whole name, else a file for each word.
std::vector<std::filesystem::path> mtl_files(const std::string& line, const std::filesystem::path& folder);

/// Adds the library's materials and their textures to the scene. A missing library or texture is a warning.
void read_mtl(const std::filesystem::path& file, Scene& scene, MaterialNames& names);

}  // namespace pentaprism
