// Commands of the contract that are refused by name until they are built.

#include "cli/commands.h"
#include "cli/options.h"

namespace pentaprism::cli {

void add_planned_commands(CLI::App& program, Run& run) {
    const std::pair<const char*, const char*> planned[] = {
        {"view", "The interactive viewer (not built yet)"},
    };
    for (const auto& [name, description] : planned) {
        CLI::App* command = program.add_subcommand(name, description);
        command->allow_extras();
        command->callback([&run, name = std::string(name)] { run = [name]() -> int { refuse_as_planned(name); }; });
    }
}

}  // namespace pentaprism::cli
