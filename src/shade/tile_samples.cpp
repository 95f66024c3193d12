#include "shade/tile_samples.h"

#include <algorithm>
#include <numeric>

namespace pentaprism {
namespace {

bool all_same(const std::uint32_t* numbers) {
    std::uint32_t difference = 0;
    for (int lane = 0; lane < kLanes; ++lane) difference |= numbers[lane] ^ numbers[0];
    return difference == 0;
}

// Rows to columns.
void transpose(const SampleVector& from, Float4* out) {
    for (int lane = 0; lane < kLanes; ++lane)
        out[lane] = Float4{from.x[lane], from.y[lane], from.u[lane], from.v[lane]};
}

}  // namespace

void TileSamples::collect(const SampleTable& samples, const SampleVector* vectors, const Tile& tile, const Hits& hits,
                          int first_block, int last_block) {
    triangles_.assign(1, kNoTriangle);
    ends_.assign(1, 0u);
    if (table_.empty()) table_.resize(1024);
    std::fill(table_.begin(), table_.end(), Known{});
    blocks_.clear();
    per_block_ = static_cast<std::uint32_t>(samples.slots()) * kLanes;
    const std::uint64_t wanted = tile.wanted_blocks();
    for (int block = first_block; block < last_block; ++block)
        if ((wanted >> block & 1u) != 0) blocks_.push_back(static_cast<std::uint32_t>(block) * per_block_);
    const std::size_t count = blocks_.size() * per_block_;
    if (locals_.size() < count) locals_.resize(count);
    if (places_.size() < count + kLanes) {
        places_.resize(count + kLanes);
        xyuv_.resize(count + kLanes);
        t_.resize(count + kLanes);
    }

    std::uint32_t* locals = locals_.data();
    for (const std::uint32_t first : blocks_) {
        find_triangles(&hits.triangle[hits.first(static_cast<int>(first / per_block_))], locals);
        locals += per_block_;
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& end : ends_) {
        const std::uint32_t here = end;
        end = sum;
        sum += here;
    }
    locals = locals_.data();
    for (const std::uint32_t first : blocks_) {
        is_by_pixel(samples) ? sort_pixels(first, locals, vectors) : sort_vectors(first, locals, vectors);
        locals += per_block_;
    }
}

// Of a block's samples.
void TileSamples::find_triangles(const std::uint32_t* triangles, std::uint32_t* locals) {
    for (std::uint32_t i = 0; i < per_block_; i += kLanes) {
        if (all_same(triangles + i)) {
            const std::uint32_t local = local_triangle(triangles[i]);
            ends_[local] += kLanes;
            std::fill_n(locals + i, kLanes, local);
            continue;
        }
        for (std::uint32_t k = i; k < i + kLanes; ++k) {
            locals[k] = local_triangle(triangles[k]);
            ++ends_[locals[k]];
        }
    }
}

void TileSamples::sort_vectors(std::uint32_t first, const std::uint32_t* locals, const SampleVector* vectors) {
    for (std::uint32_t i = 0; i < per_block_; i += kLanes) {
        const SampleVector& from = vectors[(first + i) / kLanes];
        alignas(64) Float4 xyuv[kLanes];
        transpose(from, xyuv);
        if (all_same(locals + i)) {
            std::uint32_t& to = ends_[locals[i]];
            std::iota(&places_[to], &places_[to] + kLanes, first + i);
            std::copy_n(xyuv, kLanes, &xyuv_[to]);
            std::copy_n(from.t, kLanes, &t_[to]);
            to += kLanes;
            continue;
        }
        for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
            const std::uint32_t to = ends_[locals[i + lane]]++;
            places_[to] = first + i + lane;
            xyuv_[to] = xyuv[lane];
            t_[to] = from.t[lane];
        }
    }
}

void TileSamples::sort_pixels(std::uint32_t first, const std::uint32_t* locals, const SampleVector* vectors) {
    for (std::uint32_t lane = 0; lane < kLanes; ++lane)
        for (std::uint32_t i = lane; i < per_block_; i += kLanes) {
            const std::uint32_t to = ends_[locals[i]]++;
            const SampleVector& from = vectors[(first + i) / kLanes];
            places_[to] = first + i;
            xyuv_[to] = Float4{from.x[lane], from.y[lane], from.u[lane], from.v[lane]};
            t_[to] = from.t[lane];
        }
}

// Asks the table for each sample: whether it sees the triangle of the one before is hard to predict.
std::uint32_t TileSamples::local_triangle(std::uint32_t triangle) {
    std::size_t at = first_try(triangle);
    while (table_[at].triangle != triangle) {
        if (table_[at].triangle == kNoTriangle) return add(triangle);
        at = (at + 1) & (table_.size() - 1);
    }
    return table_[at].local;
}

// The table is at most a quarter full, so that most are found at once.
std::uint32_t TileSamples::add(std::uint32_t triangle) {
    triangles_.push_back(triangle);
    ends_.push_back(0);
    const bool grows = 4 * triangles_.size() > table_.size();
    if (grows) table_.assign(2 * table_.size(), Known{});
    for (std::size_t local = grows ? 1 : triangles_.size() - 1; local < triangles_.size(); ++local) {
        std::size_t at = first_try(triangles_[local]);
        while (table_[at].triangle != kNoTriangle) at = (at + 1) & (table_.size() - 1);
        table_[at] = {triangles_[local], static_cast<std::uint32_t>(local)};
    }
    return static_cast<std::uint32_t>(triangles_.size() - 1);
}

}  // namespace pentaprism
