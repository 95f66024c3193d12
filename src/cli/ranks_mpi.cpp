// MPI, from the main thread alone. MPI's own handler ends all processes when a call fails, so none here is checked.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <mpi.h>
#include <pentaprism/error.h>
#include <vector>

#include "cli/ranks.h"

namespace pentaprism::cli {
namespace {

constexpr int kSizeTag = 1, kBytesTag = 2;
constexpr std::size_t kPiece = 8 << 20;  // bytes of a message: a count must fit an int, and memory should stay small

Ranks ranks;

class RankSource : public ByteSource {
  public:
    explicit RankSource(int rank) : rank_(rank) {
        MPI_Recv(&left_, 1, MPI_UINT64_T, rank_, kSizeTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    }
    std::string name() const override { return fmt::format("rank {}", rank_); }
    bool at_end() override { return left_ == 0 && at_ == piece_.size(); }
    void read(std::span<std::byte> bytes) override {
        while (!bytes.empty()) {
            if (at_ == piece_.size()) receive();
            const std::size_t count = std::min(bytes.size(), piece_.size() - at_);
            std::memcpy(bytes.data(), piece_.data() + at_, count);
            at_ += count;
            bytes = bytes.subspan(count);
        }
    }

  private:
    void receive() {
        if (left_ == 0) throw Error(ErrorKind::kScene, name() + ": cannot read (it ends too early)");
        piece_.resize(std::min<std::uint64_t>(left_, kPiece));
        at_ = 0;
        left_ -= piece_.size();
        MPI_Recv(piece_.data(), static_cast<int>(piece_.size()), MPI_BYTE, rank_, kBytesTag, MPI_COMM_WORLD,
                 MPI_STATUS_IGNORE);
    }
    int rank_;
    std::uint64_t left_ = 0;  // bytes that were not received yet
    std::vector<std::byte> piece_;
    std::size_t at_ = 0;
};

}  // namespace

Ranks join_ranks() {
    // Starting MPI takes a while, which a single process need not wait for.
    if (!std::getenv("OMPI_COMM_WORLD_SIZE") && !std::getenv("PMI_SIZE") && !std::getenv("PMIX_RANK")) return ranks;
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &ranks.rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks.size);
    return ranks;
}

bool first_decides(bool mine) {
    int answer = mine;
    if (!ranks.alone()) MPI_Bcast(&answer, 1, MPI_INT, 0, MPI_COMM_WORLD);
    return answer != 0;
}

void send_to_first(std::span<const std::byte> bytes) {
    const std::uint64_t size = bytes.size();
    MPI_Send(&size, 1, MPI_UINT64_T, 0, kSizeTag, MPI_COMM_WORLD);
    for (; !bytes.empty(); bytes = bytes.subspan(std::min(bytes.size(), kPiece)))
        MPI_Send(bytes.data(), static_cast<int>(std::min(bytes.size(), kPiece)), MPI_BYTE, 0, kBytesTag,
                 MPI_COMM_WORLD);
}

std::unique_ptr<ByteSource> bytes_from(int rank) {
    return std::make_unique<RankSource>(rank);
}

void leave_ranks() {
    int started = 0;
    MPI_Initialized(&started);
    if (started) MPI_Finalize();
}

void abort_ranks(int exit_code) {
    int started = 0;
    MPI_Initialized(&started);
    if (started) MPI_Abort(MPI_COMM_WORLD, exit_code);
}

}  // namespace pentaprism::cli
