#include "cull/cull_choice.h"

#include <algorithm>
#include <fmt/format.h>
#include <pentaprism/error.h>

namespace pentaprism {
namespace {

constexpr Grain kGrains[] = {Grain::kTile, Grain::kPixel, Grain::kBucket};

CullStep parse_step(const std::string& step) {
    const std::size_t at = step.find('@');
    const std::string name = step.substr(0, at);
    const CullTest* test = find_cull_test(name);
    if (test == nullptr) {
        std::string names = "auto";
        for (const CullTest* known : cull_table()) names += fmt::format(", {}", known->name);
        throw Error(ErrorKind::kUsage, name == "auto" ? "--culling: 'auto' stands alone"
                                                      : fmt::format("--culling: '{}' is not one of {}", name, names));
    }
    if (at == std::string::npos) return {test, test->grain};
    const std::string footprint = step.substr(at + 1);
    for (const Grain grain : kGrains)
        if (footprint == name_of(grain)) return {test, grain};
    throw Error(ErrorKind::kUsage,
                fmt::format("--culling {}: '{}' is not one of tile, pixel, bucket", step, footprint));
}

}  // namespace

const CullTest* find_cull_test(std::string_view name) {
    for (const CullTest* test : cull_table())
        if (name == test->name) return test;
    return nullptr;
}

const char* name_of(Grain grain) {
    constexpr const char* kNames[] = {"tile", "pixel", "bucket"};
    return kNames[static_cast<int>(grain)];
}

Culling parse_culling(const std::string& choice) {
    Culling culling;
    for (std::size_t first = 0; first <= choice.size();) {
        const std::size_t plus = std::min(choice.find('+', first), choice.size());
        culling.push_back(parse_step(choice.substr(first, plus - first)));
        first = plus + 1;
    }
    std::stable_sort(culling.begin(), culling.end(),
                     [](const CullStep& a, const CullStep& b) { return a.grain < b.grain; });
    return culling;
}

bool is_conservative(const Culling& culling) {
    return std::all_of(culling.begin(), culling.end(), [](const CullStep& step) { return step.test->conservative; });
}

}  // namespace pentaprism
