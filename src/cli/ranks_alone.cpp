// A build without MPI: one process, and a word to those who started more.

#include <cstdlib>
#include <fmt/format.h>
#include <pentaprism/error.h>

#include "cli/ranks.h"

namespace pentaprism::cli {

Ranks join_ranks() {
    for (const char* variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
        const char* size = std::getenv(variable);
        if (size && std::atoi(size) > 1)
            throw Error(ErrorKind::kBackend,
                        fmt::format("mpirun started {} processes, but this build has no MPI (packaging/apt-mpi.txt, "
                                    "-DPENTAPRISM_MPI=ON); --shard shares out work without it",
                                    size));
    }
    return {};
}

bool first_decides(bool mine) {
    return mine;
}
void send_to_first(std::span<const std::byte>) {}
std::unique_ptr<ByteSource> bytes_from(int) {
    return nullptr;
}
void leave_ranks() {}
void abort_ranks(int) {}

}  // namespace pentaprism::cli
