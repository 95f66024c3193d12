#pragma once
// Where a picture comes from, in words that stand in its header: no dates, no paths, nothing that does not change
// pixels.

#include <pentaprism/settings.h>
#include <string>

namespace pentaprism {

/// XXH3, 128 bits, as 32 hexadecimal digits (what `xxh128sum FILE` prints), of the scene file's bytes; of a .gltf
/// followed by its buffers and images in the file's order, of an .obj followed by its material libraries; of the name
/// itself for "builtin:NAME". A file that cannot be read counts as empty: reading the scene is what says so.
std::string scene_hash(const std::string& source);

/// Of the pictures that settings name: scene_hash() of each file; empty if there is none.
struct PictureHashes {
    std::string environment, aperture_image;
};
PictureHashes picture_hashes(const RenderSettings& settings);

/// One JSON object with everything that decides the pixels of `settings`, the scene's name and its hash, and what
/// picture_hashes() gives.
std::string settings_json(const RenderSettings& settings, const std::string& scene_name, const std::string& hash,
                          const PictureHashes& pictures = {});

}  // namespace pentaprism
