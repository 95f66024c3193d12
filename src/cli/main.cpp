// The program: parses the command line, runs one command, and turns every failure into one line and an exit code.

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <exception>
#include <fmt/format.h>
#include <new>
#include <pentaprism/error.h>
#include <sstream>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/memory.h"
#include "cli/messages.h"
#include "cli/ranks.h"

namespace pentaprism::cli {
namespace {

/// What the user should do next, after the library's own words on what is wrong with the command line.
std::string usage_line(const CLI::App& program, const std::string& problem) {
    std::string command = "pentaprism";
    for (const CLI::App* at = &program; !at->get_subcommands().empty();) {
        at = at->get_subcommands().front();
        command += " " + at->get_name();
    }
    return fmt::format("{}; see {} --help", problem, command);
}

/// What no command knows, also of commands within commands.
std::vector<std::string> surplus_arguments(const CLI::App& program) {
    std::vector<std::string> surplus;
    for (const CLI::App* at = &program;; at = at->get_subcommands().front()) {
        for (const std::string& argument : at->remaining()) surplus.push_back(argument);
        if (at->get_subcommands().empty()) return surplus;
    }
}

/// CLI11's words for the few mistakes that are common are not those of a sentence.
std::string problem_text(const CLI::App& program, const CLI::ParseError& error, int argc, char** argv) {
    if (program.get_subcommands().empty()) {
        return argc < 2 ? "no command is given" : fmt::format("there is no command or option '{}'", argv[1]);
    }
    const std::string words = error.what();
    if (dynamic_cast<const CLI::ExtrasError*>(&error)) {
        std::string surplus;
        for (const std::string& argument : surplus_arguments(program)) {
            if (surplus.empty() || (argument[0] == '-' && surplus[0] != '-')) surplus = argument;
        }
        return fmt::format("{} '{}'", surplus[0] == '-' ? "there is no option" : "there is one argument too many,",
                           surplus);
    }
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) {
        const std::string option = words.substr(0, words.find(':'));
        return option +
               (words.find("missing") != std::string::npos ? ": its value is missing" : ": it is given more than once");
    }
    return words;
}

int run_program(int argc, char** argv) {
    CLI::App program("Stochastic rasterization with physically right motion blur and defocus blur", "pentaprism");
    program.set_version_flag("--version", "pentaprism " PENTAPRISM_VERSION, "Print the version");
    program.set_help_flag("-h,--help", "Print this help");
    program.require_subcommand(1);
    program.get_formatter()->column_width(40);
    program.footer(
        "Each command has its own --help. Exit codes: 0 done, 1 failed, 2 usage, 3 scene, 4 output, 5 backend,\n"
        "130 and 143 interrupted.");
    Run run;
    add_render(program, run);
    add_scene(program, run);
    add_info(program, run);
    add_verify(program, run);
    add_bench(program, run);
    add_experiment(program, run);
    add_compare(program, run);
    add_merge(program, run);
    add_refocus(program, run);
    add_retime(program, run);
    add_planned_commands(program, run);
    try {
        program.parse(argc, argv);
    } catch (const CLI::Success& asked) {  // --help, --version
        std::ostringstream text;
        program.exit(asked, text, text);
        print_result(text.str());
        return 0;
    } catch (const CLI::ParseError& error) {
        throw Error(ErrorKind::kUsage, usage_line(program, problem_text(program, error, argc, argv)));
    }
    return run();
}

int report_failure() {
    try {
        throw;
    } catch (const Error& error) {
        if (caught_signal() != 0) {
            print_error("interrupted; what was finished is kept");
            return 128 + caught_signal();
        }
        print_error(error.what());
        return static_cast<int>(error.kind());
    } catch (const std::bad_alloc&) {
        print_error("out of memory; try a lower --resolution or a smaller scene");
    } catch (const std::exception& error) {
        print_error(fmt::format("internal error: {}", error.what()));
    }
    return static_cast<int>(ErrorKind::kRender);
}

int guarded_main(int argc, char** argv) {
    try {
        return run_program(argc, argv);
    } catch (...) {
        const int code = report_failure();
        abort_ranks(code);
        return code;
    }
}

}  // namespace
}  // namespace pentaprism::cli

int main(int argc, char** argv) {
    pentaprism::cli::ask_for_huge_pages();
    pentaprism::cli::watch_signals();
    return pentaprism::cli::guarded_main(argc, argv);
}
