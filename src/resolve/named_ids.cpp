#include "resolve/named_ids.h"

#include <bit>
#include <fmt/format.h>
#include <map>
#include <murmurhash.h>
#include <nlohmann/json.hpp>

namespace pentaprism {
namespace {

std::uint32_t murmur_hash(const std::string& name) {
    std::uint32_t hash = 0;
    lmmh_x86_32(name.data(), static_cast<unsigned>(name.size()), 0, &hash);
    return hash;
}

// Exponents of all zeros and all ones are those of denormals, infinities and NaNs, which programs change on the way.
std::uint32_t with_an_ordinary_exponent(std::uint32_t bits) {
    const std::uint32_t exponent = bits >> 23 & 255u;
    return exponent == 0 || exponent == 255 ? bits ^ (1u << 23) : bits;
}

std::string hexadecimal(float id) {
    return fmt::format("{:08x}", std::bit_cast<std::uint32_t>(id));
}

std::string dump(const nlohmann::ordered_json& json) {
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

std::uint32_t NamedIds::add(const std::string& name, const std::string& unnamed) {
    const std::string wanted = name.empty() ? unnamed : name;
    std::string chosen = wanted;
    for (int k = 2; !taken_.insert(chosen).second; ++k) chosen = fmt::format("{}.{}", wanted, k);
    names_.push_back(chosen);
    ids_.push_back(std::bit_cast<float>(with_an_ordinary_exponent(murmur_hash(chosen))));
    return static_cast<std::uint32_t>(names_.size());
}

std::string NamedIds::json() const {
    return dump(names_);
}

std::vector<std::pair<std::string, std::string>> NamedIds::cryptomatte_attributes(const std::string& layer) const {
    nlohmann::ordered_json manifest = nlohmann::ordered_json::object();
    for (std::size_t i = 0; i < names_.size(); ++i) manifest[names_[i]] = hexadecimal(ids_[i]);
    const std::string key = fmt::format("cryptomatte/{:.7}/", fmt::format("{:08x}", murmur_hash(layer)));
    return {{key + "name", layer},
            {key + "hash", "MurmurHash3_32"},
            {key + "conversion", "uint32_to_float32"},
            {key + "manifest", dump(manifest)}};
}

FrameIds::FrameIds(const Frame& frame) {
    std::map<std::pair<Index, Index>, std::uint32_t> known_objects;
    std::map<Index, std::uint32_t> known_materials;
    for (const Part& part : frame.parts) {
        const Placement& at = part.placement;
        auto& object = known_objects[{at.node, at.instance}];
        if (object == 0) {
            std::string name = frame.scene->nodes[at.node].name, unnamed = fmt::format("node {}", at.node);
            if (at.instance != kNone) {
                const std::string instance = fmt::format("#{}", at.instance);
                if (!name.empty()) name += instance;
                unnamed += instance;
            }
            object = objects.add(name, unnamed);
        }
        object_of_part.push_back(object);
        auto& material = known_materials[part.material];
        if (material == 0)
            material = part.material == kNone ? materials.add("", "default material")
                                              : materials.add(frame.scene->materials[part.material].name,
                                                              fmt::format("material {}", part.material));
        material_of_part.push_back(material);
    }
}

}  // namespace pentaprism
