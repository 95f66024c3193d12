#pragma once
// The processes that `mpirun -n N pentaprism render ...` starts. Alone, and in a build without MPI, there is one.

#include <cstddef>
#include <memory>
#include <pentaprism/shard.h>
#include <span>

namespace pentaprism::cli {

struct Ranks {
    int rank = 0, size = 1;
    bool first() const { return rank == 0; }
    bool alone() const { return size == 1; }
};

/// Joins the others; once, before any of the calls below. Throws Error(kBackend) where mpirun started several processes
/// and this build has no MPI: each would do all the work and write over the others' files.
Ranks join_ranks();

/// What the first process says; every process must ask.
bool first_decides(bool mine);

/// Bytes from every process but the first to the first, which reads them while they are sent.
void send_to_first(std::span<const std::byte> bytes);
std::unique_ptr<ByteSource> bytes_from(int rank);

/// At the end of successful work: waits for the others.
void leave_ranks();

/// After a failure: ends the others, too, with that exit code. Returns if there are none.
void abort_ranks(int exit_code);

}  // namespace pentaprism::cli
