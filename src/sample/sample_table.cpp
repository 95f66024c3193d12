#include "sample/sample_table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/parallel.h"
#include "sample/aperture.h"
#include "sample/motion_pattern.h"
#include "sample/net.h"
#include "sample/pixel_pattern.h"

namespace pentaprism {
namespace {

// The period is a whole number of cells; larger tables for fewer samples, where a repetition would show more.
int period_for(int spp) {
    return spp <= 16 ? 128 : spp <= 64 ? 64 : 32;
}

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

// A sample of a pattern without strata of ours: its time is one of 2^24 in a single interval.
RawSample pattern_sample(Sampler sampler, int px, int py, int index, int spp, std::uint32_t seed) {
    const auto p = pattern_point(sampler, px, py, index, spp, seed);
    return {p.x, p.y, p.u, p.v, 0, p.t >> 8};
}

bool is_by_time(Grouping grouping) {
    return grouping == Grouping::kMotion || grouping == Grouping::kTime;
}

bool is_by_time_or_both(Grouping grouping) {
    return is_by_time(grouping) || grouping == Grouping::kBoth;
}

// Slots of the samples of one pixel of such a pattern, so that those of a vector are near each other where they blur:
// by lens cell, of both or one coordinate after the other, or by time.
void order_by_blur(std::span<const RawSample> samples, Grouping grouping, std::span<std::uint16_t> slot_of_index) {
    if (grouping == Grouping::kStill) {
        for (std::size_t i = 0; i < samples.size(); ++i) slot_of_index[i] = static_cast<std::uint16_t>(i);
        return;
    }
    std::vector<std::pair<std::uint64_t, std::uint16_t>> keys;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const RawSample& s = samples[i];
        const std::uint64_t cell = is_by_time(grouping) ? 0 : (s.v >> 30) * 4 + (s.u >> 30);
        keys.emplace_back(cell << 32 | s.jitter_t, static_cast<std::uint16_t>(i));
    }
    std::sort(keys.begin(), keys.end());
    for (std::size_t slot = 0; slot < keys.size(); ++slot)
        slot_of_index[keys[slot].second] = static_cast<std::uint16_t>(slot);
}

// Which stratum a vector belongs to: lens cell and quarter of the shutter, whichever of them the grouping keeps apart.
int stratum_of(Grouping grouping, int spp, std::uint32_t base_u, std::uint32_t base_v, std::uint32_t index, int slot) {
    const int lens_cell = static_cast<int>((base_v >> 30) * 4 + (base_u >> 30));
    switch (grouping) {
        case Grouping::kStill:
            return 0;
        case Grouping::kMotion:
        case Grouping::kTime:
            return spp <= 64 ? slot : slot * 64 / spp;
        case Grouping::kDefocus:
            return lens_cell;
        case Grouping::kBoth:
            return static_cast<int>((index & ~3u) * 4 / spp) * 16 + lens_cell;
    }
    return 0;
}

// Place in the period of a lane of a block of a cell.
struct PixelPlace {
    int x, y;
};
PixelPlace pixel_place(int cell, int cells, int block, int lane) {
    return {cell % cells * kCellSize + block % kCellBlocks * kBlockSize + lane % kBlockSize,
            cell / cells * kCellSize + block / kCellBlocks * kBlockSize + lane / kBlockSize};
}

constexpr int kMostByPixel = 256;  // samples per pixel: with more, a tile by pixel is megabytes

int stratum_count(Grouping grouping, int spp) {
    switch (grouping) {
        case Grouping::kStill:
            return 1;
        case Grouping::kMotion:
        case Grouping::kTime:
            return std::min(spp, kMaxStrata);
        case Grouping::kDefocus:
            return 16;
        case Grouping::kBoth:
            return kMaxStrata;
    }
    return kMaxStrata;
}

}  // namespace

SampleTable::SampleTable(int spp, std::uint32_t seed, const Lens& lens, Grouping wanted, SamplePattern pattern,
                         SampleTimes times, CatsEye eye, Sampler sampler)
    : spp_(spp),
      period_(period_for(spp)),
      seed_(seed),
      grouping_(pattern == SamplePattern::kFree ? wanted : Grouping::kStill),
      pattern_(pattern),
      in_order_of_time_(sampler == Sampler::kStratified && is_by_time_or_both(grouping_)),
      times_(std::move(times)),
      eye_(std::move(eye)) {
    const Grouping grouping = grouping_;
    std::optional<SharedTriples> shared;
    if (pattern != SamplePattern::kFree) shared.emplace(pattern, spp, seed);
    const int cells = period_ / kCellSize;
    const std::size_t blocks = static_cast<std::size_t>(cells) * cells * kBlocksPerCell;
    vectors_.resize(blocks * spp);
    indices_.resize(blocks * spp * kLanes);
    const int strata_count = sampler == Sampler::kStratified ? stratum_count(grouping, spp)
                             : grouping == Grouping::kStill  ? 1
                                                             : std::min(spp, kMaxStrata);
    const bool by_lens = grouping == Grouping::kDefocus || grouping == Grouping::kBoth;
    const bool wants_fine_lens = by_lens && sampler == Sampler::kStratified && !is_placed();
    std::vector<std::uint8_t> stratum(blocks * spp), fine_cells(wants_fine_lens ? blocks * spp * kLanes : 0);
    std::vector<std::array<Domain, kMaxStrata>> domains(blocks);

    parallel_for(blocks, [&](std::size_t b) {
        const int cell = static_cast<int>(b) / kBlocksPerCell, in_cell = static_cast<int>(b) % kBlocksPerCell;
        const int bx = cell % cells * kCellBlocks + in_cell % kCellBlocks;
        const int by = cell / cells * kCellBlocks + in_cell / kCellBlocks;
        const BlockPattern block_pattern(spp, seed, bx, by);
        domains[b].fill(Domain::empty());
        const auto store = [&](int lane, int index, const SamplePoint& sample, int slot, int s) {
            SampleVector& vector = vectors_[b * spp + slot];
            const LocalOffset place = local_offset(in_cell, lane);
            vector.x[lane] = place.x + sample.x;
            vector.y[lane] = place.y - sample.y;
            vector.u[lane] = sample.u;
            vector.v[lane] = sample.v;
            vector.t[lane] = sample.t;
            indices_[(b * spp + slot) * kLanes + lane] = static_cast<std::uint16_t>(index);
            stratum[b * spp + slot] = static_cast<std::uint8_t>(s);
            domains[b][s].extend({sample.u, sample.u, sample.v, sample.v, sample.t, sample.t});
        };
        if (sampler != Sampler::kStratified && !shared) {
            std::vector<RawSample> raw(spp);
            std::vector<std::uint16_t> slots(spp);
            for (int lane = 0; lane < kLanes; ++lane) {
                const PixelPlace pixel = pixel_place(cell, cells, in_cell, lane);
                for (int index = 0; index < spp; ++index)
                    raw[index] = pattern_sample(sampler, pixel.x, pixel.y, index, spp, seed);
                order_by_blur(raw, grouping, slots);
                for (int index = 0; index < spp; ++index)
                    store(lane, index, to_sample(raw[index], 1, lens, times_), slots[index],
                          slots[index] * strata_count / spp);
            }
            return;
        }
        const std::vector<std::uint16_t> order = by_lens ? block_pattern.lens_order() : std::vector<std::uint16_t>();
        std::optional<MotionPattern> motion;
        if (grouping == Grouping::kMotion) motion.emplace(spp, seed, bx, by);
        std::array<MotionPattern::Place, kLanes> moving;
        for (int index = 0; index < spp; ++index) {
            if (motion) moving = motion->in_stratum(index);
            const std::uint32_t base_u = block_pattern.base_u(index), base_v = block_pattern.base_v(index);
            for (int lane = 0; lane < kLanes; ++lane) {
                RawSample raw = block_pattern.sample(lane, index);
                if (shared) {
                    const PixelPlace pixel = pixel_place(cell, cells, in_cell, lane);
                    const RawTriple triple = shared->triple(shared->triple_of(pixel.x, pixel.y, index));
                    raw = {raw.x, raw.y, triple.u, triple.v, triple.stratum_t, triple.jitter_t};
                }
                if (motion) {
                    const MotionPattern::Place& place = moving[lane];
                    raw = {place.x, place.y, raw.u, raw.v, static_cast<std::uint32_t>(index), place.jitter_t};
                }
                const int slot = by_lens                ? order[index]
                                 : is_by_time(grouping) ? static_cast<int>(raw.stratum_t)
                                                        : index;
                if (wants_fine_lens)
                    fine_cells[(b * spp + slot) * kLanes + lane] =
                        static_cast<std::uint8_t>((raw.v >> 29) * FineLens::kSide + (raw.u >> 29));
                store(lane, index, to_sample(raw, shared ? shared->count() : spp, lens, times_), slot,
                      stratum_of(grouping, spp, base_u, base_v, index, slot));
            }
        }
    });

    domains_.assign(strata_count, Domain::empty());
    for (const auto& block : domains)
        for (std::size_t s = 0; s < domains_.size(); ++s) domains_[s].extend(block[s]);

    strata_.resize(static_cast<std::size_t>(cells) * cells);
    parallel_for(strata_.size(), [&](std::size_t cell) {
        std::map<std::pair<int, int>, std::uint64_t> masks;
        for (int i = 0; i < kBlocksPerCell; ++i) {
            const std::size_t b = cell * kBlocksPerCell + i;
            for (int slot = 0; slot < spp; ++slot) masks[{slot, stratum[b * spp + slot]}] |= std::uint64_t{1} << i;
        }
        for (const auto& [key, blocks_mask] : masks)
            strata_[cell].push_back(
                {static_cast<std::uint16_t>(key.first), static_cast<std::uint16_t>(key.second), blocks_mask});
    });
    if (wants_fine_lens) fine_lens_ = FineLens(spp, vectors_, fine_cells);
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
    if (!is_placed()) return stored;
    room.assign(stored.begin(), stored.end());
    place_block(room, bx, by);
    return room;
}

std::span<const SampleVector> SampleTable::cell(int cx, int cy, std::vector<SampleVector>& room) const {
    const std::size_t vectors = static_cast<std::size_t>(kBlocksPerCell) * spp_;
    const auto stored = std::span(vectors_).subspan(cell_index(cx, cy) * vectors, vectors);
    if (!is_placed()) return stored;
    room.assign(stored.begin(), stored.end());
    for (int block = 0; block < kBlocksPerCell; ++block)
        place_block(std::span(room).subspan(static_cast<std::size_t>(block) * spp_, spp_),
                    cx * kCellBlocks + block % kCellBlocks, cy * kCellBlocks + block / kCellBlocks);
    return room;
}

// Offsets from the middle of the cell are multiples of 1/256, so the places are exact.
void SampleTable::place_block(std::span<SampleVector> vectors, int bx, int by) const {
    const double x = kCellSize * (bx / kCellBlocks + 0.5), y = kCellSize * (by / kCellBlocks + 0.5);
    if (times_.roll())
        for (SampleVector& v : vectors)
            for (int lane = 0; lane < kLanes; ++lane) v.t[lane] = times_.at(v.t[lane], x + v.x[lane], y - v.y[lane]);
    if (!eye_.on()) return;
    const CatsEye::Outline outline = eye_.outline(kBlockSize * (bx + 0.5), kBlockSize * (by + 0.5));
    for (SampleVector& v : vectors)
        for (int lane = 0; lane < kLanes; ++lane) {
            const glm::vec2 uv = outline.at({v.u[lane], v.v[lane]});
            v.u[lane] = uv.x, v.v[lane] = uv.y;
        }
}

std::span<const Domain> SampleTable::domains(int cx, int cy, std::vector<Domain>& room) const {
    if (!is_placed()) return domains_;
    room.assign(domains_.begin(), domains_.end());
    if (times_.roll()) {
        const double x = kCellSize * static_cast<double>(cx), y = kCellSize * static_cast<double>(cy);
        for (Domain& d : room) {
            const auto [t0, t1] = times_.range(d.t0, d.t1, x, x + kCellSize, y, y + kCellSize);
            d.t0 = t0, d.t1 = t1;
        }
    }
    if (eye_.on()) fit_lens(cx, cy, room);
    return room;
}

// The lens points of a cell's own samples.
void SampleTable::fit_lens(int cx, int cy, std::vector<Domain>& domains) const {
    static thread_local std::vector<SampleVector> room;
    const std::span<const SampleVector> vectors = cell(cx, cy, room);
    constexpr Domain kEmpty = Domain::empty();
    for (Domain& d : domains) d = {kEmpty.u0, kEmpty.u1, kEmpty.v0, kEmpty.v1, d.t0, d.t1};
    for (const Stratum& s : strata(cx, cy))
        for (int block = 0; block < kBlocksPerCell; ++block) {
            if (!(s.blocks >> block & 1u)) continue;
            const SampleVector& v = vectors[static_cast<std::size_t>(block) * spp_ + s.slot];
            Domain& d = domains[s.stratum];
            const auto [u0, u1] = std::minmax_element(std::begin(v.u), std::end(v.u));
            const auto [v0, v1] = std::minmax_element(std::begin(v.v), std::end(v.v));
            d = {std::min(d.u0, *u0), std::max(d.u1, *u1), std::min(d.v0, *v0), std::max(d.v1, *v1), d.t0, d.t1};
        }
}

std::span<const std::uint16_t> SampleTable::indices(int bx, int by) const {
    return std::span(indices_).subspan(block_index(bx, by) * spp_ * kLanes, static_cast<std::size_t>(spp_) * kLanes);
}

std::span<const std::uint16_t> SampleTable::indices_of_cell(int cx, int cy) const {
    const std::size_t per_cell = std::size_t{kCellSize} * kCellSize * spp_;
    return std::span(indices_).subspan(cell_index(cx, cy) * per_cell, per_cell);
}

std::span<const Stratum> SampleTable::strata(int cx, int cy) const {
    return strata_[cell_index(cx, cy)];
}

int SampleTable::slot_of(int px, int py, int index) const {
    const std::uint16_t* index_of =
        &indices(px / kBlockSize, py / kBlockSize)[py % kBlockSize * kBlockSize + px % kBlockSize];
    int slot = index;  // which it is where nothing blurs
    if (index_of[slot * kLanes] != index)
        for (slot = 0; index_of[slot * kLanes] != index;) ++slot;
    return slot;
}

SamplePoint SampleTable::sample(int px, int py, int index) const {
    const int lane = py % kBlockSize * kBlockSize + px % kBlockSize;
    const SampleVector& vector = block(px / kBlockSize, py / kBlockSize)[slot_of(px, py, index)];
    const int block = py % kCellSize / kBlockSize * kCellBlocks + px % kCellSize / kBlockSize;
    const LocalOffset place = local_offset(block, lane);
    const float x = vector.x[lane] - place.x, y = place.y - vector.y[lane];
    glm::vec2 uv(vector.u[lane], vector.v[lane]);
    if (eye_.on()) uv = eye_.outline(kBlockSize * (px / kBlockSize + 0.5), kBlockSize * (py / kBlockSize + 0.5)).at(uv);
    return {x, y, uv.x, uv.y, times_.at(vector.t[lane], px + static_cast<double>(x), py + static_cast<double>(y))};
}

}  // namespace pentaprism
