// The JSON types of glTF 2.0's members (appendix B of the specification). Whoever reads a member checks it, too, but
// objects that nothing refers to are read by nobody, and a file with a wrong type anywhere is not to be trusted.

#include <cmath>
#include <fmt/format.h>

#include "scene/gltf_parts.h"

namespace pentaprism::gltf {

namespace {

enum class Type { kObject, kArray, kString, kNumber, kInteger, kBoolean };

struct Rule {
    Type type;
    const char* paths;  ///< separated by spaces; "[]": each element, "*": each member
};

constexpr Rule kRules[] = {
    {Type::kObject,
     "asset accessors[] accessors[].sparse accessors[].sparse.indices accessors[].sparse.values animations[] "
     "animations[].channels[] animations[].channels[].target animations[].samplers[] buffers[] bufferViews[] cameras[] "
     "cameras[].perspective cameras[].orthographic images[] materials[] materials[].pbrMetallicRoughness "
     "materials[].pbrMetallicRoughness.baseColorTexture materials[].pbrMetallicRoughness.metallicRoughnessTexture "
     "materials[].normalTexture materials[].occlusionTexture materials[].emissiveTexture meshes[] "
     "meshes[].primitives[] "
     "meshes[].primitives[].attributes meshes[].primitives[].targets[] nodes[] samplers[] scenes[] skins[] textures[]"},
    {Type::kObject,
     "extensions.* asset.extensions.* accessors[].extensions.* animations[].extensions.* "
     "animations[].channels[].extensions.* animations[].channels[].target.extensions.* buffers[].extensions.* "
     "bufferViews[].extensions.* cameras[].extensions.* images[].extensions.* materials[].extensions.* "
     "meshes[].extensions.* meshes[].primitives[].extensions.* nodes[].extensions.* samplers[].extensions.* "
     "scenes[].extensions.* skins[].extensions.* textures[].extensions.*"},
    {Type::kArray,
     "extensionsUsed extensionsRequired accessors accessors[].min accessors[].max animations animations[].channels "
     "animations[].samplers buffers bufferViews cameras images materials materials[].emissiveFactor "
     "materials[].pbrMetallicRoughness.baseColorFactor meshes meshes[].primitives meshes[].primitives[].targets "
     "meshes[].weights nodes nodes[].children nodes[].matrix nodes[].rotation nodes[].scale nodes[].translation "
     "nodes[].weights samplers scenes scenes[].nodes skins skins[].joints textures"},
    {Type::kString,
     "extensionsUsed[] extensionsRequired[] asset.version asset.minVersion asset.generator asset.copyright "
     "accessors[].type accessors[].name animations[].name animations[].channels[].target.path "
     "animations[].samplers[].interpolation buffers[].uri buffers[].name bufferViews[].name cameras[].type "
     "cameras[].name images[].uri images[].mimeType images[].name materials[].alphaMode materials[].name meshes[].name "
     "nodes[].name samplers[].name scenes[].name skins[].name textures[].name "
     "extensions.KHR_materials_variants.variants[].name"},
    {Type::kNumber,
     "accessors[].min[] accessors[].max[] cameras[].perspective.* cameras[].orthographic.* materials[].alphaCutoff "
     "materials[].emissiveFactor[] materials[].pbrMetallicRoughness.baseColorFactor[] "
     "materials[].pbrMetallicRoughness.metallicFactor materials[].pbrMetallicRoughness.roughnessFactor "
     "materials[].normalTexture.scale materials[].occlusionTexture.strength meshes[].weights[] nodes[].matrix[] "
     "nodes[].rotation[] nodes[].scale[] nodes[].translation[] nodes[].weights[]"},
    {Type::kInteger,
     "scene accessors[].bufferView accessors[].byteOffset accessors[].componentType accessors[].count "
     "accessors[].sparse.count accessors[].sparse.indices.bufferView accessors[].sparse.indices.byteOffset "
     "accessors[].sparse.indices.componentType accessors[].sparse.values.bufferView "
     "accessors[].sparse.values.byteOffset "
     "animations[].channels[].sampler animations[].channels[].target.node animations[].samplers[].input "
     "animations[].samplers[].output buffers[].byteLength bufferViews[].buffer bufferViews[].byteOffset "
     "bufferViews[].byteLength bufferViews[].byteStride bufferViews[].target images[].bufferView "
     "meshes[].primitives[].attributes.* meshes[].primitives[].indices meshes[].primitives[].material "
     "meshes[].primitives[].mode meshes[].primitives[].targets[].* nodes[].camera nodes[].children[] nodes[].mesh "
     "nodes[].skin samplers[].magFilter samplers[].minFilter samplers[].wrapS samplers[].wrapT scenes[].nodes[] "
     "skins[].inverseBindMatrices skins[].skeleton skins[].joints[] textures[].sampler textures[].source"},
    {Type::kBoolean, "accessors[].normalized materials[].doubleSided"},
};

bool has_type(const Json& value, Type type) {
    switch (type) {
        case Type::kObject:
            return value.is_object();
        case Type::kArray:
            return value.is_array();
        case Type::kString:
            return value.is_string();
        case Type::kNumber:
            return value.is_number();
        case Type::kBoolean:
            return value.is_boolean();
        case Type::kInteger:
            return value.is_number_integer() ||
                   (value.is_number_float() && value.get<double>() == std::floor(value.get<double>()));
    }
    return false;
}

const char* name_of(Type type) {
    switch (type) {
        case Type::kObject:
            return "an object";
        case Type::kArray:
            return "an array";
        case Type::kString:
            return "a string";
        case Type::kNumber:
            return "a number";
        case Type::kInteger:
            return "an integer";
        case Type::kBoolean:
            return "true or false";
    }
    return "";
}

/// Follows the rest of a path from a value; what is absent or of another kind than the path goes through is some other
/// rule's business.
class Walk {
  public:
    Walk(const Document& document, Type type) : document_(document), type_(type) {}

    void run(const Json& value, std::string_view path) {
        if (path.empty()) {
            if (!has_type(value, type_)) document_.fail(fmt::format("{} is not {}", place(), name_of(type_)));
            return;
        }
        if (path.starts_with("[]")) {
            if (!value.is_array()) return;
            for (std::size_t i = 0; i < value.size(); ++i) {
                steps_.push_back(fmt::format("[{}]", i));
                run(value[i], path.substr(2));
                steps_.pop_back();
            }
            return;
        }
        if (path.front() == '.') path.remove_prefix(1);
        if (!value.is_object()) return;
        const std::size_t end = std::min(path.find_first_of(".["), path.size());
        const std::string key(path.substr(0, end));
        const bool free_form = key == "*";
        for (auto member = free_form ? value.begin() : value.find(key); member != value.end(); ++member) {
            if (!free_form || (member.key() != "extras" && member.key() != "extensions")) {
                steps_.push_back((steps_.empty() ? "" : ".") + member.key());
                run(*member, path.substr(end));
                steps_.pop_back();
            }
            if (!free_form) break;
        }
    }

  private:
    std::string place() const {
        std::string text;
        for (const std::string& step : steps_) text += step;
        return text;
    }

    const Document& document_;
    Type type_;
    std::vector<std::string> steps_;
};

}  // namespace

void check_types(const Document& document) {
    for (const Rule& rule : kRules) {
        std::string_view paths = rule.paths;
        while (!paths.empty()) {
            const std::size_t end = std::min(paths.find(' '), paths.size());
            Walk(document, rule.type).run(document.json, paths.substr(0, end));
            paths.remove_prefix(std::min(end + 1, paths.size()));
        }
    }
}

}  // namespace pentaprism::gltf
