#include "sample/sample_table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/parallel.h"
#include "sample/aperture.h"
#include "sample/net.h"

namespace pentaprism {
namespace {

// The period is a whole number of cells; larger tables for fewer samples, where a repetition would show more.
int period_for(int spp) {
    return spp <= 16 ? 128 : spp <= 64 ? 64 : 32;
}

// The sixteen pixels of a block share the first base-4 digit of u, v and t of each index, so that a vector is close in
// lens and time; their second digits are a net of their own over the block: with columns and rows as elements of GF(4),
// each line of pixels and each pair of dimensions sees all digits once.
struct LaneDigits {
    std::uint32_t u, v, t;
};
LaneDigits lane_digits(int lane) {
    constexpr std::uint32_t kTimesW[4] = {0, 2, 3, 1}, kTimesW2[4] = {0, 3, 1, 2};
    const std::uint32_t column = lane % kBlockSize, row = lane / kBlockSize;
    return {column ^ kTimesW[row], column ^ kTimesW2[row], column ^ row};
}

// 32-bit coordinates of one sample before the map to the lens.
struct RawSample {
    std::uint32_t x, y, u, v;
    std::uint32_t stratum_t;  // of spp
    std::uint32_t jitter_t;   // within it, 24 bits
};

// All samples of one block: pure functions of the block's place, the seed, the lane and the index.
class BlockPattern {
  public:
    BlockPattern(int spp, std::uint32_t seed, int bx, int by) : spp_(spp) {
        const std::uint32_t place =
            mix(static_cast<std::uint32_t>(bx) * 0x9e3779b9u + mix(static_cast<std::uint32_t>(by) + 1u));
        block_ = mix(place + seed * 0x85ebca6bu + 0x1b873593u);
    }

    // First digits of u and v: the same for all lanes.
    std::uint32_t base_u(std::uint32_t index) const { return owen_scramble(net_point(index)[2], mix(block_ + 3u)); }
    std::uint32_t base_v(std::uint32_t index) const { return owen_scramble(net_point(index)[3], mix(block_ + 4u)); }

    RawSample sample(int lane, std::uint32_t index) const {
        const auto point = net_point(index);
        const std::uint32_t pixel = mix(block_ + 0x9e3779b9u * (lane + 1u));
        const LaneDigits digits = lane_digits(lane);
        RawSample raw;
        raw.x = owen_scramble(point[0], mix(pixel + 1u));
        raw.y = owen_scramble(point[1], mix(pixel + 2u));
        raw.u = owen_scramble(point[2], mix(block_ + 3u)) ^ shift(digits.u, mix(pixel + 3u));
        raw.v = owen_scramble(point[3], mix(block_ + 4u)) ^ shift(digits.v, mix(pixel + 4u));
        const std::uint32_t low_digit = (digits.t ^ mix(block_ + 6u)) & 3u;
        raw.stratum_t = spp_ % 4 == 0 ? index ^ low_digit : index;
        raw.jitter_t = mix(pixel + 5u + 0x9e3779b9u * index) >> 8;
        return raw;
    }

  private:
    // A digital shift that leaves the first digit alone, sets the second to `digit` and is random below.
    static std::uint32_t shift(std::uint32_t digit, std::uint32_t random) { return (digit << 28) | (random >> 4); }

    int spp_;
    std::uint32_t block_;
};

// `strata`: intervals of the shutter, one of which is raw.stratum_t.
SamplePoint to_sample(const RawSample& raw, int strata, const Lens& lens, const SampleTimes& times) {
    constexpr double kUnit = 1.0 / 4294967296.0;
    SamplePoint sample;
    sample.x = static_cast<float>(raw.x >> 24) / 256.0f;
    sample.y = static_cast<float>(raw.y >> 24) / 256.0f;
    const glm::dvec2 uv = aperture_point(lens, raw.u * kUnit, raw.v * kUnit);
    const float limit = static_cast<float>(lens.ratio);
    sample.u = std::clamp(static_cast<float>(uv.x), -1.0f, 1.0f);
    sample.v = std::clamp(static_cast<float>(uv.y), -limit, limit);
    const std::uint64_t t =
        ((static_cast<std::uint64_t>(raw.stratum_t) << 24) | raw.jitter_t) / static_cast<unsigned>(strata);
    sample.t = times.within_exposure(static_cast<std::uint32_t>(t));
    return sample;
}

// Top left corner of a pixel, from the middle of its cell, y up.
struct LocalOffset {
    float x, y;
};
LocalOffset local_offset(int block, int lane) {
    constexpr int half = kCellSize / 2;
    return {static_cast<float>(block % kCellBlocks * kBlockSize + lane % kBlockSize - half),
            static_cast<float>(half - block / kCellBlocks * kBlockSize - lane / kBlockSize)};
}

// Slot of each index in lens order: groups of sixteen consecutive indices hold each of the 4x4 lens cells once, so a
// whole group is laid out by cell; the remainder of spp / 16 in ascending order of its cells.
std::vector<std::uint16_t> lens_order(const BlockPattern& pattern, int spp) {
    std::vector<std::uint16_t> slot_of_index(spp);
    for (int first = 0; first < spp; first += 16) {
        const int last = std::min(first + 16, spp);
        std::vector<std::pair<std::uint32_t, int>> cells;
        for (int i = first; i < last; ++i)
            cells.emplace_back((pattern.base_v(i) >> 30) * 4 + (pattern.base_u(i) >> 30), i);
        std::sort(cells.begin(), cells.end());
        for (int rank = 0; rank < last - first; ++rank)
            slot_of_index[cells[rank].second] = static_cast<std::uint16_t>(first + rank);
    }
    return slot_of_index;
}

// Which stratum a vector belongs to: lens cell and quarter of the shutter, whichever of them the grouping keeps apart.
int stratum_of(Grouping grouping, int spp, std::uint32_t base_u, std::uint32_t base_v, std::uint32_t index, int slot) {
    const int lens_cell = static_cast<int>((base_v >> 30) * 4 + (base_u >> 30));
    switch (grouping) {
        case Grouping::kStill:
            return 0;
        case Grouping::kMotion:
            return spp <= 64 ? slot : slot * 64 / spp;
        case Grouping::kDefocus:
            return lens_cell;
        case Grouping::kBoth:
            return static_cast<int>((index & ~3u) * 4 / spp) * 16 + lens_cell;
    }
    return 0;
}

constexpr int kMaxStrata = 64;
constexpr int kMostByPixel = 256;  // samples per pixel: with more, a tile by pixel is megabytes

int stratum_count(Grouping grouping, int spp) {
    switch (grouping) {
        case Grouping::kStill:
            return 1;
        case Grouping::kMotion:
            return std::min(spp, kMaxStrata);
        case Grouping::kDefocus:
            return 16;
        case Grouping::kBoth:
            return kMaxStrata;
    }
    return kMaxStrata;
}

constexpr Domain kEmptyDomain = {2, -2, 1e30f, -1e30f, 2, -2};

void extend(Domain& domain, const Domain& other) {
    domain.u0 = std::min(domain.u0, other.u0);
    domain.u1 = std::max(domain.u1, other.u1);
    domain.v0 = std::min(domain.v0, other.v0);
    domain.v1 = std::max(domain.v1, other.v1);
    domain.t0 = std::min(domain.t0, other.t0);
    domain.t1 = std::max(domain.t1, other.t1);
}

}  // namespace

SampleTable::SampleTable(int spp, std::uint32_t seed, const Lens& lens, Grouping wanted, SamplePattern pattern,
                         SampleTimes times)
    : spp_(spp),
      period_(period_for(spp)),
      seed_(seed),
      grouping_(pattern == SamplePattern::kFree ? wanted : Grouping::kStill),
      pattern_(pattern),
      times_(std::move(times)) {
    const Grouping grouping = grouping_;
    std::optional<SharedTriples> shared;
    if (pattern != SamplePattern::kFree) shared.emplace(pattern, spp, seed);
    const int cells = period_ / kCellSize;
    const std::size_t blocks = static_cast<std::size_t>(cells) * cells * kBlocksPerCell;
    vectors_.resize(blocks * spp);
    indices_.resize(blocks * spp * kLanes);
    slots_.resize(blocks * spp * kLanes);
    std::vector<std::uint8_t> stratum(blocks * spp);
    std::vector<std::array<Domain, kMaxStrata>> domains(blocks);

    parallel_for(blocks, [&](std::size_t b) {
        const int cell = static_cast<int>(b) / kBlocksPerCell, in_cell = static_cast<int>(b) % kBlocksPerCell;
        const BlockPattern block_pattern(spp, seed, cell % cells * kCellBlocks + in_cell % kCellBlocks,
                                         cell / cells * kCellBlocks + in_cell / kCellBlocks);
        domains[b].fill(kEmptyDomain);
        const bool by_lens = grouping == Grouping::kDefocus || grouping == Grouping::kBoth;
        const std::vector<std::uint16_t> order =
            by_lens ? lens_order(block_pattern, spp) : std::vector<std::uint16_t>();
        for (int index = 0; index < spp; ++index) {
            const std::uint32_t base_u = block_pattern.base_u(index), base_v = block_pattern.base_v(index);
            for (int lane = 0; lane < kLanes; ++lane) {
                RawSample raw = block_pattern.sample(lane, index);
                if (shared) {
                    const int column = in_cell % kCellBlocks * kBlockSize + lane % kBlockSize;
                    const int row = in_cell / kCellBlocks * kBlockSize + lane / kBlockSize;
                    const RawTriple triple = shared->triple(
                        shared->triple_of(cell % cells * kCellSize + column, cell / cells * kCellSize + row, index));
                    raw = {raw.x, raw.y, triple.u, triple.v, triple.stratum_t, triple.jitter_t};
                }
                const SamplePoint sample = to_sample(raw, shared ? shared->count() : spp, lens, times_);
                const int slot = by_lens                         ? order[index]
                                 : grouping == Grouping::kMotion ? static_cast<int>(raw.stratum_t)
                                                                 : index;
                SampleVector& vector = vectors_[b * spp + slot];
                const LocalOffset place = local_offset(static_cast<int>(b) % kBlocksPerCell, lane);
                vector.x[lane] = place.x + sample.x;
                vector.y[lane] = place.y - sample.y;
                vector.u[lane] = sample.u;
                vector.v[lane] = sample.v;
                vector.t[lane] = sample.t;
                indices_[(b * spp + slot) * kLanes + lane] = static_cast<std::uint16_t>(index);
                slots_[(b * kLanes + lane) * spp + index] = static_cast<std::uint16_t>(slot);
                const int s = stratum_of(grouping, spp, base_u, base_v, index, slot);
                stratum[b * spp + slot] = static_cast<std::uint8_t>(s);
                extend(domains[b][s], {sample.u, sample.u, sample.v, sample.v, sample.t, sample.t});
            }
        }
    });

    domains_.assign(stratum_count(grouping, spp), kEmptyDomain);
    for (const auto& block : domains)
        for (std::size_t s = 0; s < domains_.size(); ++s) extend(domains_[s], block[s]);

    strata_.resize(static_cast<std::size_t>(cells) * cells);
    for (int cell = 0; cell < cells * cells; ++cell) {
        std::map<std::pair<int, int>, std::uint64_t> masks;
        for (int i = 0; i < kBlocksPerCell; ++i) {
            const std::size_t b = static_cast<std::size_t>(cell) * kBlocksPerCell + i;
            for (int slot = 0; slot < spp; ++slot) masks[{slot, stratum[b * spp + slot]}] |= std::uint64_t{1} << i;
        }
        for (const auto& [key, blocks_mask] : masks)
            strata_[cell].push_back(
                {static_cast<std::uint16_t>(key.first), static_cast<std::uint16_t>(key.second), blocks_mask});
    }
    if (shared)
        arrange_by_triple(*shared);
    else if (grouping == Grouping::kStill && spp % kLanes == 0 && spp <= kMostByPixel)
        arrange_by_pixel();
}

// Where nothing blurs, slots are in the order of indices.
void SampleTable::arrange_by_pixel() {
    pixel_x_.resize(vectors_.size() * kLanes);
    pixel_y_.resize(vectors_.size() * kLanes);
    const std::size_t spp = static_cast<std::size_t>(spp_);
    for (std::size_t i = 0; i < vectors_.size(); ++i)
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const std::size_t to = (i / spp * kLanes + lane) * spp + i % spp;
            pixel_x_[to] = vectors_[i].x[lane];
            pixel_y_[to] = vectors_[i].y[lane];
        }
}

PixelSamples SampleTable::by_pixel(int cx, int cy) const {
    if (pixel_x_.empty()) return {};
    const std::size_t per_cell = std::size_t{kCellSize} * kCellSize * spp_, first = cell_index(cx, cy) * per_cell;
    return {std::span<const float>(pixel_x_.data(), pixel_x_.size()).subspan(first, per_cell),
            std::span<const float>(pixel_y_.data(), pixel_y_.size()).subspan(first, per_cell)};
}

void SampleTable::arrange_by_triple(const SharedTriples& shared) {
    block_side_ = shared.block_side();
    triples_.resize(shared.count());
    const int cells = period_ / kCellSize, side = kCellSize / block_side_;
    const std::size_t per_cell = std::size_t{kCellSize} * kCellSize * spp_;
    shared_x_.resize(per_cell * cells * cells);
    shared_y_.resize(shared_x_.size());
    shared_places_.resize(shared_x_.size());
    for (int cell = 0; cell < cells * cells; ++cell)
        for (int pixel = 0; pixel < kCellSize * kCellSize; ++pixel) {
            const int column = pixel % kCellSize, row = pixel / kCellSize;
            const int block = row / kBlockSize * kCellBlocks + column / kBlockSize;
            const int lane = row % kBlockSize * kBlockSize + column % kBlockSize;
            for (int index = 0; index < spp_; ++index) {
                const int triple =
                    shared.triple_of(cell % cells * kCellSize + column, cell / cells * kCellSize + row, index);
                const std::size_t place = (static_cast<std::size_t>(block) * spp_ + index) * kLanes + lane;
                const SampleVector& vector = vectors_[cell * (per_cell / kLanes) + place / kLanes];
                const std::size_t to = cell * per_cell +
                                       (static_cast<std::size_t>(triple) * side + row / block_side_) * side +
                                       column / block_side_;
                shared_x_[to] = vector.x[lane];
                shared_y_[to] = vector.y[lane];
                shared_places_[to] = static_cast<std::uint32_t>(place);
                triples_[triple] = {vector.u[lane], vector.v[lane], vector.t[lane]};
            }
        }
}

SharedSamples SampleTable::shared(int cx, int cy) const {
    const std::size_t per_cell = std::size_t{kCellSize} * kCellSize * spp_, first = cell_index(cx, cy) * per_cell;
    return {block_side_,
            kCellSize / block_side_,
            triples_,
            std::span<const float>(shared_x_.data(), shared_x_.size()).subspan(first, per_cell),
            std::span<const float>(shared_y_.data(), shared_y_.size()).subspan(first, per_cell),
            std::span(shared_places_).subspan(first, per_cell)};
}

// The picture is paved with periods, each shifted by a whole number of cells so that repetitions do not line up.
std::size_t SampleTable::cell_index(int cx, int cy) const {
    const int cells = period_ / kCellSize;
    const std::uint32_t hash =
        mix(mix(static_cast<std::uint32_t>(cx / cells) + seed_) + static_cast<std::uint32_t>(cy / cells));
    const int x = (cx + static_cast<int>(hash & 0xff)) % cells, y = (cy + static_cast<int>((hash >> 8) & 0xff)) % cells;
    return static_cast<std::size_t>(y) * cells + x;
}

std::size_t SampleTable::block_index(int bx, int by) const {
    return cell_index(bx / kCellBlocks, by / kCellBlocks) * kBlocksPerCell + by % kCellBlocks * kCellBlocks +
           bx % kCellBlocks;
}

std::span<const SampleVector> SampleTable::block(int bx, int by) const {
    return std::span(vectors_).subspan(block_index(bx, by) * spp_, spp_);
}

std::span<const SampleVector> SampleTable::block(int bx, int by, std::vector<SampleVector>& room) const {
    const std::span<const SampleVector> stored = block(bx, by);
    if (!times_.roll()) return stored;
    room.assign(stored.begin(), stored.end());
    roll(room, bx / kCellBlocks, by / kCellBlocks);
    return room;
}

std::span<const SampleVector> SampleTable::cell(int cx, int cy, std::vector<SampleVector>& room) const {
    const std::size_t vectors = static_cast<std::size_t>(kBlocksPerCell) * spp_;
    const auto stored = std::span(vectors_).subspan(cell_index(cx, cy) * vectors, vectors);
    if (!times_.roll()) return stored;
    room.assign(stored.begin(), stored.end());
    roll(room, cx, cy);
    return room;
}

// Offsets from the middle of the cell are multiples of 1/256, so the places are exact.
void SampleTable::roll(std::span<SampleVector> vectors, int cx, int cy) const {
    const double x = kCellSize * (cx + 0.5), y = kCellSize * (cy + 0.5);
    for (SampleVector& v : vectors)
        for (int lane = 0; lane < kLanes; ++lane) v.t[lane] = times_.at(v.t[lane], x + v.x[lane], y - v.y[lane]);
}

std::span<const Domain> SampleTable::domains(int cx, int cy, std::vector<Domain>& room) const {
    if (!times_.roll()) return domains_;
    room.assign(domains_.begin(), domains_.end());
    const double x = kCellSize * static_cast<double>(cx), y = kCellSize * static_cast<double>(cy);
    for (Domain& d : room) {
        const auto [t0, t1] = times_.range(d.t0, d.t1, x, x + kCellSize, y, y + kCellSize);
        d.t0 = t0, d.t1 = t1;
    }
    return room;
}

std::span<const std::uint16_t> SampleTable::indices(int bx, int by) const {
    return std::span(indices_).subspan(block_index(bx, by) * spp_ * kLanes, static_cast<std::size_t>(spp_) * kLanes);
}

std::span<const SampleTable::Stratum> SampleTable::strata(int cx, int cy) const {
    return strata_[cell_index(cx, cy)];
}

int SampleTable::slot_of(int px, int py, int index) const {
    const int lane = py % kBlockSize * kBlockSize + px % kBlockSize;
    return slots_[(block_index(px / kBlockSize, py / kBlockSize) * kLanes + lane) * spp_ + index];
}

SamplePoint SampleTable::sample(int px, int py, int index) const {
    const int lane = py % kBlockSize * kBlockSize + px % kBlockSize;
    const SampleVector& vector = block(px / kBlockSize, py / kBlockSize)[slot_of(px, py, index)];
    const int block = py % kCellSize / kBlockSize * kCellBlocks + px % kCellSize / kBlockSize;
    const LocalOffset place = local_offset(block, lane);
    const float x = vector.x[lane] - place.x, y = place.y - vector.y[lane];
    return {x, y, vector.u[lane], vector.v[lane],
            times_.at(vector.t[lane], px + static_cast<double>(x), py + static_cast<double>(y))};
}

}  // namespace pentaprism
