#include <cctype>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <pentaprism/metadata.h>
#include <vector>

#include "base/hash.h"
#include "scene/mtl_reader.h"

namespace pentaprism {
namespace {

namespace fs = std::filesystem;

std::string lower_case(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

std::string percent_decoded(const std::string& uri) {
    std::string text;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] == '%' && i + 2 < uri.size() && std::isxdigit(static_cast<unsigned char>(uri[i + 1])) &&
            std::isxdigit(static_cast<unsigned char>(uri[i + 2]))) {
            text += static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16));
            i += 2;
        } else {
            text += uri[i];
        }
    }
    return text;
}

std::vector<fs::path> gltf_companions(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    const nlohmann::json document = nlohmann::json::parse(stream, nullptr, false);
    std::vector<fs::path> files;
    if (!document.is_object()) return files;
    for (const char* list : {"buffers", "images"}) {
        const auto entries = document.find(list);
        if (entries == document.end() || !entries->is_array()) continue;
        for (const auto& entry : *entries) {
            if (!entry.is_object() || !entry.contains("uri") || !entry["uri"].is_string()) continue;
            const auto uri = entry["uri"].get<std::string>();
            if (uri.rfind("data:", 0) != 0) files.push_back(file.parent_path() / percent_decoded(uri));
        }
    }
    return files;
}

std::vector<fs::path> obj_companions(const fs::path& file) {
    std::vector<fs::path> files;
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);)
        for (const fs::path& library : mtl_files(line, file.parent_path())) files.push_back(library);
    return files;
}

}  // namespace

std::string scene_hash(const std::string& source) {
    Hash hash;
    if (source.rfind("builtin:", 0) == 0) {
        hash.add(source.data(), source.size());
        return hash.hex();
    }
    const fs::path file(source);
    hash.add_file(file);
    std::vector<fs::path> companions;
    const std::string suffix = lower_case(file.extension().string());
    if (suffix == ".gltf") companions = gltf_companions(file);
    if (suffix == ".obj") companions = obj_companions(file);
    for (const fs::path& companion : companions) hash.add_file(companion);
    return hash.hex();
}

}  // namespace pentaprism
