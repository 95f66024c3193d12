#include "gl/culling.h"

#include <algorithm>
#include <fmt/format.h>
#include <pentaprism/error.h>

#include "gl/program.h"

namespace pentaprism::gl {
namespace {

std::string path_of(const std::string& name) {
    return "cull/" + stem_of(name) + ".glsl";
}

bool has_twin(const std::string& name) {
    const auto sources = shader_sources();
    return std::any_of(sources.begin(), sources.end(),
                       [path = path_of(name)](const ShaderSource& source) { return source.path == path; });
}

}  // namespace

std::string stem_of(const std::string& name) {
    std::string stem = name;
    std::replace(stem.begin(), stem.end(), '-', '_');
    return stem;
}

std::vector<std::string> culling_names() {
    std::vector<std::string> names;
    for (const CullTest* test : cull_table())
        if (has_twin(test->name)) names.emplace_back(test->name);
    return names;
}

Culling parse_gl_culling(const std::string& choice) {
    const Culling culling = parse_culling(choice == "auto" ? "bbox" : choice);
    for (const CullStep& step : culling) {
        if (!has_twin(step.test->name))
            throw Error(ErrorKind::kUsage, fmt::format("--culling {}: not with --backend gl, which has auto, {}",
                                                       step.test->name, fmt::join(culling_names(), ", ")));
        if (step.grain == Grain::kBucket)
            throw Error(ErrorKind::kUsage,
                        fmt::format("--culling {}@bucket: not with --backend gl, which takes a sample at a time",
                                    step.test->name));
    }
    return culling;
}

bool asks_hull_of_pixels(const Culling& culling) {
    return std::any_of(culling.begin(), culling.end(), [](const CullStep& step) {
        return std::string_view(step.test->name) == "hull" && step.grain == Grain::kPixel;
    });
}

std::string culling_shader(const Culling& culling) {
    std::string text = "#include \"gl/footprint.glsl\"\n", tests;
    for (const CullStep& step : culling) {
        text += fmt::format("#include \"{}\"\n", path_of(step.test->name));
        tests += fmt::format("{}{}_keeps(T, square_of(place, {}), sampled)", tests.empty() ? "" : " && ",
                             stem_of(step.test->name), step.grain == Grain::kTile ? kCullTileSize : 1);
    }
    return text + fmt::format(
                      "bool culling_keeps(LocalTriangle T, LocalSample sampled, ivec2 place) {{\n"
                      "    return {};\n}}\n",
                      tests);
}

}  // namespace pentaprism::gl
