#include "sample/block_pattern.h"

#include <algorithm>
#include <utility>

#include "sample/net.h"

namespace pentaprism {
namespace {

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

// A digital shift that leaves the first digit alone, sets the second to `digit` and is random below.
std::uint32_t shift(std::uint32_t digit, std::uint32_t random) {
    return (digit << 28) | (random >> 4);
}

}  // namespace

BlockPattern::BlockPattern(int spp, std::uint32_t seed, int bx, int by) : spp_(spp) {
    const std::uint32_t place =
        mix(static_cast<std::uint32_t>(bx) * 0x9e3779b9u + mix(static_cast<std::uint32_t>(by) + 1u));
    block_ = mix(place + seed * 0x85ebca6bu + 0x1b873593u);
}

std::uint32_t BlockPattern::base_u(std::uint32_t index) const {
    return owen_scramble(net_point(index)[2], mix(block_ + 3u));
}

std::uint32_t BlockPattern::base_v(std::uint32_t index) const {
    return owen_scramble(net_point(index)[3], mix(block_ + 4u));
}

RawSample BlockPattern::sample(int lane, std::uint32_t index) const {
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

std::vector<std::uint16_t> BlockPattern::lens_order() const {
    std::vector<std::uint16_t> slot_of_index(spp_);
    for (int first = 0; first < spp_; first += 16) {
        const int last = std::min(first + 16, spp_);
        std::vector<std::pair<std::uint32_t, int>> cells;
        for (int i = first; i < last; ++i) cells.emplace_back((base_v(i) >> 30) * 4 + (base_u(i) >> 30), i);
        std::sort(cells.begin(), cells.end());
        for (int rank = 0; rank < last - first; ++rank)
            slot_of_index[cells[rank].second] = static_cast<std::uint16_t>(first + rank);
    }
    return slot_of_index;
}

}  // namespace pentaprism
