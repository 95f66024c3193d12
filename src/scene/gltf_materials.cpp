// Textures, samplers and materials (glTF 2.0, 3.8 and 3.9) with KHR_texture_transform and KHR_materials_unlit,
// emissive_strength, ior, specular, clearcoat, sheen and transmission.

#include <algorithm>
#include <fmt/format.h>
#include <glm/common.hpp>

#include "scene/gltf_parts.h"

namespace pentaprism::gltf {

namespace {

enum SamplerConstant {
    kNearest = 9728,
    kLinear = 9729,
    kNearestMipmapNearest = 9984,
    kLinearMipmapLinear = 9987,
    kClampToEdge = 33071,
    kMirroredRepeat = 33648,
    kRepeat = 10497
};

Wrap read_wrap(const Object& sampler, const char* key) {
    switch (sampler.integer(key, kRepeat)) {
        case kRepeat:
            return Wrap::kRepeat;
        case kMirroredRepeat:
            return Wrap::kMirroredRepeat;
        case kClampToEdge:
            return Wrap::kClampToEdge;
        default:
            sampler.fail(fmt::format("has an unknown {} {}", key, sampler.integer(key, 0)));
    }
}

void read_sampler(const Object& sampler, TextureRef& texture) {
    texture.wrap_s = read_wrap(sampler, "wrapS");
    texture.wrap_t = read_wrap(sampler, "wrapT");
    const std::int64_t magnification = sampler.integer("magFilter", kLinear),
                       minification = sampler.integer("minFilter", kLinearMipmapLinear);
    if (magnification != kNearest && magnification != kLinear)
        sampler.fail(fmt::format("has an unknown magFilter {}", magnification));
    const bool levels = minification >= kNearestMipmapNearest && minification <= kLinearMipmapLinear;
    if (!levels && minification != kNearest && minification != kLinear)
        sampler.fail(fmt::format("has an unknown minFilter {}", minification));
    texture.nearest = magnification == kNearest;
    texture.mipmapped = levels;
}

void read_transform(Document& document, const Object& info, TextureRef& texture) {
    if (!info.has_extension("KHR_texture_transform")) return;
    const Object transform = info.extension("KHR_texture_transform");
    if (const auto offset = transform.numbers("offset", 2); !offset.empty()) texture.offset = {offset[0], offset[1]};
    if (const auto scale = transform.numbers("scale", 2); !scale.empty()) texture.scale = {scale[0], scale[1]};
    texture.rotation = static_cast<float>(transform.number("rotation", 0.0));
    texture.texcoord = static_cast<int>(
        std::min<std::size_t>(transform.size("texCoord", static_cast<std::size_t>(texture.texcoord)), 1000));
    (void)document;
}

TextureRef read_texture_info(Document& document, const Scene& scene, const Object& owner, const char* key) {
    TextureRef result;
    if (!owner.has(key)) return result;
    const Object info = owner.child(key);
    if (!info.has("index")) info.fail("has no index");
    const auto texture_index = static_cast<std::size_t>(info.index("index", "textures"));
    result.texcoord = static_cast<int>(std::min<std::size_t>(info.size("texCoord", 0), 1000));
    read_transform(document, info, result);
    if (result.texcoord > 1) {
        document.warn(fmt::format("{} uses texture coordinates {}; only 0 and 1 are read, and it is left out",
                                  info.where(), result.texcoord));
        return {};
    }
    const Object texture = document.item("textures", "texture", texture_index);
    if (const Index sampler = texture.index("sampler", "samplers"); sampler != kNone) {
        read_sampler(document.item("samplers", "sampler", static_cast<std::size_t>(sampler)), result);
    }
    const Index source = texture.index("source", "images");
    if (source == kNone) {
        document.warn(texture.where() + " has no image that can be read; materials are shown without it");
    } else if (!scene.images[static_cast<std::size_t>(source)].texels.empty()) {
        result.image = source;
    }
    return result;
}

void read_metallic_roughness(Document& document, const Scene& scene, const Object& object, Material& material) {
    if (!object.has("pbrMetallicRoughness")) return;
    const Object pbr = object.child("pbrMetallicRoughness");
    if (const auto color = pbr.numbers("baseColorFactor", 4); !color.empty())
        material.base_color = {color[0], color[1], color[2], color[3]};
    material.metallic = static_cast<float>(pbr.number("metallicFactor", 1.0));
    material.roughness = static_cast<float>(pbr.number("roughnessFactor", 1.0));
    material.base_color_texture = read_texture_info(document, scene, pbr, "baseColorTexture");
    material.metallic_roughness_texture = read_texture_info(document, scene, pbr, "metallicRoughnessTexture");
}

void read_emission(Document& document, const Scene& scene, const Object& object, Material& material) {
    if (const auto color = object.numbers("emissiveFactor", 3); !color.empty())
        material.emissive = {color[0], color[1], color[2]};
    material.emissive_texture = read_texture_info(document, scene, object, "emissiveTexture");
    if (!object.has_extension("KHR_materials_emissive_strength")) return;
    const Object extension = object.extension("KHR_materials_emissive_strength");
    const double strength = extension.number("emissiveStrength", 1.0);
    if (strength < 0.0) document.warn(extension.where() + " has a negative emissiveStrength; 0 is used");
    material.emissive *= static_cast<float>(std::max(strength, 0.0));
}

void read_alpha(const Object& object, Material& material) {
    const std::string mode = object.text("alphaMode", "OPAQUE");
    if (mode == "OPAQUE") {
        material.alpha_mode = AlphaMode::kOpaque;
    } else if (mode == "MASK") {
        material.alpha_mode = AlphaMode::kMask;
    } else if (mode == "BLEND") {
        material.alpha_mode = AlphaMode::kBlend;
    } else {
        object.fail(fmt::format("has an unknown alphaMode \"{}\"", mode));
    }
    material.alpha_cutoff = static_cast<float>(object.number("alphaCutoff", 0.5));
}

/// Factors beyond their range would make light; they are cut to it.
template <class T>
void clamp_factor(Document& document, const Object& object, const char* name, T& value, T low, T high) {
    const T clamped = std::clamp(value, low, high);
    if (clamped != value)
        document.warn(fmt::format("{} has a {} of {}; {} is used", object.where(), name, value, clamped));
    value = clamped;
}

glm::vec3 read_color(const Object& object, const char* key, const glm::vec3& otherwise) {
    const auto color = object.numbers(key, 3);
    return color.empty() ? otherwise : glm::vec3(color[0], color[1], color[2]);
}

void read_specular(Document& document, const Scene& scene, const Object& object, Material& material) {
    if (object.has_extension("KHR_materials_ior")) {
        const Object ior = object.extension("KHR_materials_ior");
        material.ior = static_cast<float>(ior.number("ior", 1.5));
        if (!(material.ior == 0.0f || material.ior >= 1.0f)) {
            document.warn(fmt::format("{} has an index of refraction of {}; 1 is used", ior.where(), material.ior));
            material.ior = 1.0f;
        }
    }
    if (!object.has_extension("KHR_materials_specular")) return;
    const Object specular = object.extension("KHR_materials_specular");
    material.specular = static_cast<float>(specular.number("specularFactor", 1.0));
    material.specular_texture = read_texture_info(document, scene, specular, "specularTexture");
    material.specular_color = glm::max(read_color(specular, "specularColorFactor", glm::vec3(1.0f)), glm::vec3(0.0f));
    material.specular_color_texture = read_texture_info(document, scene, specular, "specularColorTexture");
    clamp_factor(document, specular, "specularFactor", material.specular, 0.0f, 1.0f);
}

void read_layers(Document& document, const Scene& scene, const Object& object, Material& material) {
    if (object.has_extension("KHR_materials_clearcoat")) {
        const Object coat = object.extension("KHR_materials_clearcoat");
        material.clearcoat = static_cast<float>(coat.number("clearcoatFactor", 0.0));
        material.clearcoat_roughness = static_cast<float>(coat.number("clearcoatRoughnessFactor", 0.0));
        material.clearcoat_texture = read_texture_info(document, scene, coat, "clearcoatTexture");
        material.clearcoat_roughness_texture = read_texture_info(document, scene, coat, "clearcoatRoughnessTexture");
        material.clearcoat_normal_texture = read_texture_info(document, scene, coat, "clearcoatNormalTexture");
        if (coat.has("clearcoatNormalTexture"))
            material.clearcoat_normal_scale =
                static_cast<float>(coat.child("clearcoatNormalTexture").number("scale", 1.0));
        clamp_factor(document, coat, "clearcoatFactor", material.clearcoat, 0.0f, 1.0f);
        clamp_factor(document, coat, "clearcoatRoughnessFactor", material.clearcoat_roughness, 0.0f, 1.0f);
    }
    if (object.has_extension("KHR_materials_sheen")) {
        const Object sheen = object.extension("KHR_materials_sheen");
        material.sheen_color = read_color(sheen, "sheenColorFactor", glm::vec3(0.0f));
        material.sheen_color_texture = read_texture_info(document, scene, sheen, "sheenColorTexture");
        material.sheen_roughness = static_cast<float>(sheen.number("sheenRoughnessFactor", 0.0));
        material.sheen_roughness_texture = read_texture_info(document, scene, sheen, "sheenRoughnessTexture");
        for (int k = 0; k < 3; ++k)
            clamp_factor(document, sheen, "sheenColorFactor", material.sheen_color[k], 0.0f, 1.0f);
        clamp_factor(document, sheen, "sheenRoughnessFactor", material.sheen_roughness, 0.0f, 1.0f);
    }
    if (object.has_extension("KHR_materials_transmission")) {
        const Object glass = object.extension("KHR_materials_transmission");
        material.transmission = static_cast<float>(glass.number("transmissionFactor", 0.0));
        material.transmission_texture = read_texture_info(document, scene, glass, "transmissionTexture");
        clamp_factor(document, glass, "transmissionFactor", material.transmission, 0.0f, 1.0f);
    }
}

Material read_material(Document& document, const Scene& scene, const Object& object) {
    Material material;
    material.name = object.text("name");
    read_metallic_roughness(document, scene, object, material);
    read_emission(document, scene, object, material);
    read_alpha(object, material);
    read_specular(document, scene, object, material);
    read_layers(document, scene, object, material);
    material.double_sided = object.boolean("doubleSided", false);
    material.unlit = object.has_extension("KHR_materials_unlit");
    material.normal_texture = read_texture_info(document, scene, object, "normalTexture");
    if (object.has("normalTexture"))
        material.normal_scale = static_cast<float>(object.child("normalTexture").number("scale", 1.0));
    material.occlusion_texture = read_texture_info(document, scene, object, "occlusionTexture");
    if (object.has("occlusionTexture"))
        material.occlusion_strength = static_cast<float>(object.child("occlusionTexture").number("strength", 1.0));

    for (int k = 0; k < 4; ++k) clamp_factor(document, object, "baseColorFactor", material.base_color[k], 0.0f, 1.0f);
    clamp_factor(document, object, "metallicFactor", material.metallic, 0.0f, 1.0f);
    clamp_factor(document, object, "roughnessFactor", material.roughness, 0.0f, 1.0f);
    clamp_factor(document, object, "occlusionTexture strength", material.occlusion_strength, 0.0f, 1.0f);
    for (int k = 0; k < 3; ++k) clamp_factor(document, object, "emissiveFactor", material.emissive[k], 0.0f, 1e9f);
    return material;
}

}  // namespace

void read_materials(Document& document, Scene& scene) {
    for (std::size_t i = 0; i < document.count("textures"); ++i) {
        const Object texture = document.item("textures", "texture", i);
        texture.index("source", "images");
        texture.index("sampler", "samplers");
    }
    for (std::size_t i = 0; i < document.count("samplers"); ++i) {
        TextureRef unused;
        read_sampler(document.item("samplers", "sampler", i), unused);
    }
    for (std::size_t i = 0; i < document.count("materials"); ++i) {
        scene.materials.push_back(read_material(document, scene, document.item("materials", "material", i)));
    }
}

}  // namespace pentaprism::gltf
