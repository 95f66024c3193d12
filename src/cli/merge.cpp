// `pentaprism merge SHARD... -o OUT`: the parts of a frame to its picture.

#include <filesystem>
#include <memory>
#include <pentaprism/shard.h>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/options.h"
#include "cli/output_names.h"

namespace pentaprism::cli {
namespace {

struct MergeCommand {
    std::vector<std::string> shards;
    std::filesystem::path out;
};

int merge(const MergeCommand& command) {
    check_picture_name(command.out, false);
    check_output_name(command.out, "--output");
    std::vector<std::unique_ptr<ByteSource>> sources;
    for (const std::string& shard : command.shards) sources.push_back(open_shard_file(shard));
    ShardMerger merger(std::move(sources));
    check_picture_name(command.out, !merger.info().aovs.empty());
    set_picture_threads(2);
    const auto writer = make_picture_writer(command.out, merger.image(), merger.metadata());
    merger.merge(*writer);
    throw_if_interrupted();
    writer->finish();
    return 0;
}

}  // namespace

void add_merge(CLI::App& program, Run& run) {
    CLI::App* command = program.add_subcommand("merge", "Join the shards of a frame to its picture");
    const auto state = std::make_shared<MergeCommand>();
    command->add_option("SHARD", state->shards, "All files that `render --shard I/N` wrote for a frame, in any order")
        ->required()
        ->type_name("");
    add_value(*command, "Options", "-o,--output", "OUT", "Picture: .exr (linear) or .png (tone-mapped)",
              [state](const std::string& text) { state->out = text; })
        ->required();
    command->callback([state, &run] { run = [state] { return merge(*state); }; });
}

}  // namespace pentaprism::cli
