#pragma once
// What a glTF file says of a camera's lens and shutter.

#include "scene/gltf_document.h"

namespace pentaprism::gltf {

/// From a camera's EXT_cameras_sensor, else from the `extras` of the camera or of the node that holds it. What is
/// already set in `lens` is kept, so call it for the camera first.
void read_lens(Document& document, const Object& camera_or_node, LensInfo& lens);

}  // namespace pentaprism::gltf
