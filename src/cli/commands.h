#pragma once
// The commands of the program. Each add_ function declares its options; once a command line has asked for it, `run`
// is what to do: it returns the exit code or throws Error.

#include <CLI/App.hpp>
#include <functional>

namespace pentaprism::cli {

using Run = std::function<int()>;

void add_render(CLI::App& program, Run& run);
void add_scene(CLI::App& program, Run& run);
void add_info(CLI::App& program, Run& run);
void add_verify(CLI::App& program, Run& run);
void add_bench(CLI::App& program, Run& run);
void add_experiment(CLI::App& program, Run& run);
void add_compare(CLI::App& program, Run& run);
void add_merge(CLI::App& program, Run& run);
void add_refocus(CLI::App& program, Run& run);
void add_retime(CLI::App& program, Run& run);

/// Commands of the contract that are refused by name: view.
void add_planned_commands(CLI::App& program, Run& run);

}  // namespace pentaprism::cli
