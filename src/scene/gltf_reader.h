#pragma once
// glTF 2.0 files, text or binary (https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html).

#include <filesystem>
#include <pentaprism/scene.h>

namespace pentaprism {

/// Reads a `.gltf` or `.glb` with the buffers and images it names. Nothing in the file is trusted: throws Error(kScene)
/// with the file's name, the object and what is wrong with it; what can be shown though not as meant is in
/// Scene::warnings.
Scene load_gltf(const std::filesystem::path& file);

}  // namespace pentaprism
