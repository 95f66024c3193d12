// Which glTF extensions are shown as meant, and what is lost with the others.

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <string_view>

#include "scene/gltf_parts.h"

namespace pentaprism::gltf {

namespace {

constexpr std::string_view kSupported[] = {
    "EXT_cameras_sensor",    "EXT_mesh_gpu_instancing", "EXT_meshopt_compression",         "KHR_draco_mesh_compression",
    "KHR_lights_punctual",   "KHR_materials_unlit",     "KHR_materials_emissive_strength", "KHR_mesh_quantization",
    "KHR_texture_transform", "KHR_node_visibility",     "KHR_materials_clearcoat",         "KHR_materials_ior",
    "KHR_materials_sheen",   "KHR_materials_specular",  "KHR_materials_transmission",      "KHR_animation_pointer",
};

/// Known ones that change nothing in a picture.
constexpr std::string_view kHarmless[] = {"KHR_xmp", "KHR_xmp_json_ld", "EXT_structural_metadata"};

struct Loss {
    std::string_view name, what;
};
constexpr Loss kLosses[] = {
    {"KHR_materials_anisotropy", "highlights are round"},
    {"KHR_materials_dispersion", "glass does not spread colours"},
    {"KHR_materials_iridescence", "thin films show no colours"},
    {"KHR_materials_pbrSpecularGlossiness", "materials show their metallic-roughness values"},
    {"KHR_materials_diffuse_transmission", "leaves and cloth let no light through"},
    {"KHR_materials_variants", "the default variant is shown"},
    {"KHR_materials_volume", "glass has no thickness"},
    {"KHR_texture_basisu", "KTX2 textures are missing"},
    {"EXT_texture_webp", "WebP textures are missing"},
    {"EXT_texture_avif", "AVIF textures are missing"},
    {"MSFT_texture_dds", "DDS textures are missing"},
    {"EXT_lights_image_based", "the environment's light is missing"},
    {"MSFT_lod", "the finest level of detail is shown"},
};

std::vector<std::string> names(const Document& document, const char* list) {
    std::vector<std::string> result;
    for (std::size_t i = 0; i < document.count(list); ++i) {
        const Json& name = document.json.at(list).at(i);
        if (!name.is_string()) document.fail(fmt::format("{} has an entry that is not a string", list));
        result.push_back(name.get<std::string>());
    }
    return result;
}

bool contains(std::span<const std::string_view> list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
}

/// Variants are not shown, but what they refer to must exist.
void check_variants(const Document& document) {
    constexpr const char* kVariants = "KHR_materials_variants";
    const std::size_t count = document.root().has_extension(kVariants)
                                  ? document.root().extension(kVariants).children("variants", "variant").size()
                                  : 0;
    for (std::size_t i = 0; i < document.count("meshes"); ++i) {
        for (const Object& primitive : document.item("meshes", "mesh", i).children("primitives", "primitive")) {
            if (!primitive.has_extension(kVariants)) continue;
            for (const Object& mapping : primitive.extension(kVariants).children("mappings", "mapping")) {
                mapping.index("material", "materials");
                for (const double variant : mapping.numbers("variants", 0)) {
                    if (!(variant >= 0.0) || variant >= double(count)) {
                        mapping.fail(fmt::format("refers to variant {}, but there are {}", variant, count));
                    }
                }
            }
        }
    }
}

}  // namespace

void check_extensions(Document& document) {
    const auto required = names(document, "extensionsRequired"), used = names(document, "extensionsUsed");
    for (const std::string& name : required) {
        if (contains(kSupported, name) || contains(kHarmless, name)) continue;
        document.fail(fmt::format("requires the glTF extension {}, which is not supported", name));
    }
    check_variants(document);
    for (const std::string& name : used) {
        if (contains(kSupported, name) || contains(kHarmless, name)) continue;
        const auto loss =
            std::find_if(std::begin(kLosses), std::end(kLosses), [&](const Loss& entry) { return entry.name == name; });
        document.warn(fmt::format("uses the glTF extension {}, which is not supported: {}", name,
                                  loss == std::end(kLosses) ? "what it adds is not shown" : loss->what));
    }
}

}  // namespace pentaprism::gltf
