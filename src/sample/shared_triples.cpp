#include "sample/shared_triples.h"

#include "sample/net.h"

namespace pentaprism {
namespace {

constexpr int kFewestTriples = 64;
constexpr int kNetPoints = 4096;  // that net_point() has

int block_side_for(SamplePattern pattern, int spp) {
    if (pattern == SamplePattern::kAccumulation) return 1;
    int side = 2;
    while (side * side * spp < kFewestTriples) side *= 2;
    return side;
}

// Which of its interval's triples a pixel takes must change with the index, or the pixel would see one side of the lens
// alone. With this choice (over GF(4), of the index's base-4 digits 0 and 2), found by trying all, 4, 16 and 64 samples
// of a pixel fall into as many cells of the lens.
std::uint32_t digit_of_index(std::uint32_t index) {
    constexpr std::uint32_t kTimes3[4] = {0, 3, 1, 2};
    return (index & 3u) ^ kTimes3[index >> 4 & 3u];
}

}  // namespace

SharedTriples::SharedTriples(SamplePattern pattern, int spp, std::uint32_t seed)
    : side_(block_side_for(pattern, spp)), count_(side_ * side_ * spp), seed_(mix(seed * 0x85ebca6bu + 0x6a09e667u)) {}

// The index over N is the net's fifth coordinate: (u, v) and t are stratified together, too.
RawTriple SharedTriples::triple(int number) const {
    const std::uint32_t run = mix(seed_ + static_cast<std::uint32_t>(number / kNetPoints));
    const auto point = net_point(static_cast<std::uint32_t>(number % kNetPoints));
    return {owen_scramble(point[2], mix(run + 1u)), owen_scramble(point[3], mix(run + 2u)),
            static_cast<std::uint32_t>(number), mix(run + 3u + 0x9e3779b9u * static_cast<std::uint32_t>(number)) >> 8};
}

int SharedTriples::triple_of(int px, int py, int index) const {
    const std::uint32_t pixels = static_cast<std::uint32_t>(side_ * side_);
    if (pixels == 1) return index;
    const std::uint32_t column = static_cast<std::uint32_t>(px / side_), row = static_cast<std::uint32_t>(py / side_);
    const std::uint32_t place = static_cast<std::uint32_t>(py % side_ * side_ + px % side_);
    // Exclusive or with anything that depends on the block and the index alone is a permutation of the block's pixels.
    const std::uint32_t of_block = mix(seed_ + 4u + column) ^ mix(seed_ + 0x9e3779b9u + row);
    const std::uint32_t of_index = 0x55u * digit_of_index(static_cast<std::uint32_t>(index));
    return index * static_cast<int>(pixels) + static_cast<int>((place ^ of_block ^ of_index) & (pixels - 1u));
}

}  // namespace pentaprism
