#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <pentaprism/metadata.h>
#include <sstream>
#include <vector>

#include "base/hash.h"

namespace pentaprism {
namespace {

namespace fs = std::filesystem;

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
    for (std::string line; std::getline(stream, line);) {
        std::istringstream words(line);
        std::string word;
        if (!(words >> word) || word != "mtllib") continue;
        while (words >> word) files.push_back(file.parent_path() / word);
    }
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
    if (file.extension() == ".gltf") companions = gltf_companions(file);
    if (file.extension() == ".obj") companions = obj_companions(file);
    for (const fs::path& companion : companions) hash.add_file(companion);
    return hash.hex();
}

}  // namespace pentaprism
