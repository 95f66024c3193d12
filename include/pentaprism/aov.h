#pragma once
// Arbitrary output variables: ground truth of the very samples that made the blurred picture. Each says what it means
// where a pixel sees several surfaces. Unless a rule says otherwise a channel is a mean over the pixel's own samples
// that hit something, all with the same weight (a box filter of one pixel, whatever filter the colour has), and 0 where
// none does.

#include <cstdint>
#include <pentaprism/settings.h>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pentaprism {

/// Whole numbers are kept as the bits of an unsigned 32-bit integer in the place of a float.
struct ChannelInfo {
    std::string name;
    bool whole_number = false;
};

struct AovInfo {
    Aov aov;
    const char* name;  ///< in `--aov` and as the name of its part in an EXR file
    const char* rule;  ///< what a pixel holds, in one line
    std::vector<ChannelInfo> channels;
};

/// All of them, in the order of Aov.
std::span<const AovInfo> aov_table();
const AovInfo& aov_info(Aov aov);

/// Throws Error(kUsage) for a name that aov_table() does not have, with the names it has.
Aov aov_named(std::string_view name);

/// Pairs of an id and its coverage that Cryptomatte keeps for a pixel, best covered first.
inline constexpr int kCryptomatteRanks = 6;

}  // namespace pentaprism
