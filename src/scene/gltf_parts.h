#pragma once
// The readers of a glTF file's parts, in the order in which load_gltf calls them; each fills its vectors of the Scene.

#include <pentaprism/scene.h>

#include "scene/gltf_document.h"

namespace pentaprism::gltf {

/// Throws where a member of the JSON has a type that glTF does not allow there.
void check_types(const Document& document);

/// Refuses required extensions that are not supported and warns of used ones.
void check_extensions(Document& document);

void read_images(Document& document, Scene& scene);
void read_materials(Document& document, Scene& scene);

void read_meshes(Document& document, Scene& scene);
/// Attribute data and triangles of a primitive compressed by KHR_draco_mesh_compression.
struct DracoMesh {
    struct Attribute {
        std::string name;  ///< "POSITION"
        int components = 0;
        std::vector<float> values;
        std::vector<std::uint32_t> integers;  ///< for JOINTS_n
    };
    std::size_t vertex_count = 0;
    std::vector<Attribute> attributes;
    std::vector<std::uint32_t> indices;
};
DracoMesh decode_draco(const Document& document, const Object& primitive);

void read_cameras(Document& document, Scene& scene);
void read_lights(Document& document, Scene& scene);
void read_nodes(Document& document, Scene& scene);          ///< after meshes, cameras and lights
void check_lenses(Document& document, const Scene& scene);  ///< after nodes, whose extras may describe a lens
void read_skins(Document& document, Scene& scene);          ///< after nodes: also checks joints of meshes against skins
void read_roots(Document& document, Scene& scene);          ///< checks the hierarchy and which nodes are shown
void read_animations(Document& document, Scene& scene);

}  // namespace pentaprism::gltf
