// `pentaprism scene NAME -o FILE.glb` and `pentaprism scene --list`: the built-in scenes.

#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <pentaprism/error.h>
#include <pentaprism/scene.h>

#include "cli/commands.h"
#include "cli/messages.h"
#include "cli/options.h"

namespace pentaprism::cli {
namespace {

using Json = nlohmann::ordered_json;

struct SceneCommand {
    std::string name;
    std::filesystem::path out;
    bool list = false, json = false;
};

int list(bool as_json) {
    if (as_json) {
        Json scenes = Json::array();
        for (const BuiltinScene& scene : builtin_scenes()) {
            scenes.push_back(
                {{"name", scene.name}, {"triangles", scene.triangles}, {"description", scene.description}});
        }
        print_result(scenes.dump(2) + "\n");
        return 0;
    }
    std::string text;
    for (const BuiltinScene& scene : builtin_scenes()) {
        text += fmt::format("{:<14} {:>9} triangles  {}\n", scene.name, scene.triangles, scene.description);
    }
    print_result(text);
    return 0;
}

int write(const SceneCommand& command) {
    if (command.name.empty()) throw Error(ErrorKind::kUsage, "scene: give a NAME and -o FILE.glb, or --list");
    if (command.out.empty())
        throw Error(ErrorKind::kUsage, fmt::format("scene {}: --output FILE.glb is missing", command.name));
    if (command.out.extension() != ".glb") {
        throw Error(ErrorKind::kUsage, fmt::format("--output {}: the name must end in .glb", command.out.string()));
    }
    const std::string prefix = "builtin:";
    const bool has_prefix = command.name.rfind(prefix, 0) == 0;
    write_glb(make_builtin_scene(has_prefix ? command.name.substr(prefix.size()) : command.name), command.out);
    return 0;
}

}  // namespace

void add_scene(CLI::App& program, Run& run) {
    CLI::App* command = program.add_subcommand("scene", "Write a built-in scene as .glb, or list them");
    const auto state = std::make_shared<SceneCommand>();
    CLI::Option* name = command->add_option("NAME", state->name, "A name that --list shows")->type_name("");
    CLI::Option* out = add_value(*command, "Options", "-o,--output", "FILE.glb", "The file to write",
                                 [state](const std::string& text) { state->out = text; });
    CLI::Option* list_option = command->add_flag("--list", state->list, "List the built-in scenes");
    list_option->excludes(name)->excludes(out);
    command->add_flag("--json", state->json, "The list as JSON")->needs(list_option);
    command->callback([state, &run] { run = [state] { return state->list ? list(state->json) : write(*state); }; });
}

}  // namespace pentaprism::cli
