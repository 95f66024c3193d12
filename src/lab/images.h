#pragma once
// The pictures of the report: frames, heat maps of tests, what was lost.

#include "lab/walk.h"

namespace pentaprism {

/// Appends the maps of all methods: one scale of colours for all of them. Methods that record no map have none; what
/// was lost is shown where anything was.
void add_map_images(const std::vector<MethodMap>& maps, const Picture& picture, int spp, const std::string& scene,
                    const std::string& effect, std::vector<BenchImage>& images);

BenchImage picture_image(const Picture& picture, const std::string& scene, const std::string& effect);

}  // namespace pentaprism
