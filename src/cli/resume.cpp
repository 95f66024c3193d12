#include "cli/resume.h"

#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <pentaprism/error.h>
#include <pentaprism/stored_samples.h>

namespace pentaprism::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string dump(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// Of a picture, a shard, or a data set's frames/NNNN.json. Throws Error(kScene).
FileMetadata metadata_of(const std::filesystem::path& file) {
    if (file.extension() == ".shard") return read_shard_metadata(file);
    if (file.extension() == ".5ds") return read_samples_metadata(file);
    if (file.extension() != ".json") return read_metadata(file);
    std::ifstream stream(file);
    const Json json = Json::parse(stream, nullptr, false);
    if (!json.is_object() || !json.contains("settings")) throw Error(ErrorKind::kScene, "not a frame's");
    FileMetadata metadata;
    metadata.settings_json = dump(json["settings"]);
    metadata.software = json.value("software", "");
    return metadata;
}

std::string value_of(const Json& settings, const std::string& key) {
    return settings.contains(key) ? dump(settings[key]) : "not set";
}

// "spp is 4 there and 8 now"; empty if nothing differs.
std::string first_difference(const Json& there, const Json& now) {
    for (const Json* one : {&now, &there})
        for (const auto& [key, value] : one->items()) {
            const std::string a = value_of(there, key), b = value_of(now, key);
            if (a != b) return fmt::format("{} is {} there and {} now", key, a, b);
        }
    return {};
}

}  // namespace

void check_made_with(const std::filesystem::path& file, const FileMetadata& now) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return;
    const auto refuse = [&](const std::string& why) {
        throw Error(ErrorKind::kUsage,
                    fmt::format("--resume: {}: {}; write elsewhere, or over it with --overwrite", file.string(), why));
    };
    FileMetadata there;
    try {
        there = metadata_of(file);
    } catch (const std::exception&) {
        refuse("it is there and cannot be read");
    }
    const Json settings = Json::parse(there.settings_json, nullptr, false);
    if (!settings.is_object()) refuse("it does not say how it was made");
    if (const std::string what = first_difference(settings, Json::parse(now.settings_json)); !what.empty())
        refuse("it was made with other settings: " + what);
    if (there.software != now.software)
        refuse(fmt::format("it was made by {}, and this is {}", there.software, now.software));
}

}  // namespace pentaprism::cli
