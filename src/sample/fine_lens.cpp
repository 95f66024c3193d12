#include "sample/fine_lens.h"

#include <algorithm>
#include <atomic>

#include "base/parallel.h"

namespace pentaprism {
namespace {

constexpr int kLensCells = FineLens::kSide * FineLens::kSide;
constexpr int kMostSamples = 256;

}  // namespace

FineLens::FineLens(int spp, std::span<const SampleVector> vectors, std::span<const std::uint8_t> lens_cells) {
    if (spp % kLanes != 0 || spp > kMostSamples) return;
    block_size_ = spp % kLensCells == 0 ? kBlockSize : 2 * kBlockSize;
    slots_ = block_size_ * block_size_ * spp / kLanes;
    const int side = kCellSize / block_size_, blocks = side * side, per_lens_cell = slots_ / kLensCells;
    vectors_per_cell_ = static_cast<std::size_t>(slots_) * blocks;
    const std::size_t cells = vectors.size() / vectors_per_cell_, per_cell = vectors_per_cell_ * kLanes;
    vectors_.resize(vectors.size());
    places_.resize(vectors.size() * kLanes);
    std::vector<std::vector<Domain>> domains(cells, std::vector<Domain>(kLensCells, Domain::empty()));
    std::atomic<bool> even = true;
    parallel_for(cells, [&](std::size_t cell) {
        const SampleVector* from = &vectors[cell * vectors_per_cell_];
        const std::uint8_t* lens_cell_of = &lens_cells[cell * per_cell];
        std::vector<std::vector<std::uint32_t>> groups(static_cast<std::size_t>(kLensCells) * blocks);
        for (std::uint32_t place = 0; place < per_cell; ++place) {
            const int block = static_cast<int>(place / (kLanes * spp));
            const int row = block / kCellBlocks * kBlockSize / block_size_,
                      column = block % kCellBlocks * kBlockSize / block_size_;
            groups[static_cast<std::size_t>(lens_cell_of[place]) * blocks + row * side + column].push_back(place);
        }
        const auto time = [&](std::uint32_t place) { return from[place / kLanes].t[place % kLanes]; };
        for (std::size_t g = 0; g < groups.size(); ++g) {
            std::vector<std::uint32_t>& group = groups[g];
            if (group.size() != static_cast<std::size_t>(per_lens_cell) * kLanes) {
                even = false;
                return;
            }
            if (per_lens_cell > 1)
                std::stable_sort(group.begin(), group.end(),
                                 [&](std::uint32_t a, std::uint32_t b) { return time(a) < time(b); });
            const std::size_t lens_cell = g / blocks, block = g % blocks;
            for (std::size_t i = 0; i < group.size(); ++i) {
                const std::size_t slot = lens_cell * per_lens_cell + i / kLanes;
                const std::size_t to = cell * vectors_per_cell_ + slot * blocks + block, lane = i % kLanes;
                const SampleVector& source = from[group[i] / kLanes];
                const std::size_t k = group[i] % kLanes;
                SampleVector& vector = vectors_[to];
                vector.x[lane] = source.x[k], vector.y[lane] = source.y[k];
                vector.u[lane] = source.u[k], vector.v[lane] = source.v[k], vector.t[lane] = source.t[k];
                places_[to * kLanes + lane] = group[i];
                domains[cell][lens_cell].extend(
                    {vector.u[lane], vector.u[lane], vector.v[lane], vector.v[lane], vector.t[lane], vector.t[lane]});
            }
        }
    });
    if (!even) {
        *this = FineLens();
        return;
    }
    domains_.assign(kLensCells, Domain::empty());
    for (const std::vector<Domain>& of_cell : domains)
        for (int i = 0; i < kLensCells; ++i) domains_[i].extend(of_cell[i]);
    std::uint64_t all = 0;
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column) all |= std::uint64_t{1} << (kCellBlocks * row + column);
    for (int slot = 0; slot < slots_; ++slot)
        strata_.push_back({static_cast<std::uint16_t>(slot), static_cast<std::uint16_t>(slot / per_lens_cell), all});
}

std::span<const SampleVector> FineLens::cell(std::size_t cell) const {
    return std::span(vectors_).subspan(cell * vectors_per_cell_, vectors_per_cell_);
}

std::span<const std::uint32_t> FineLens::places(std::size_t cell) const {
    return std::span(places_).subspan(cell * vectors_per_cell_ * kLanes, vectors_per_cell_ * kLanes);
}

}  // namespace pentaprism
