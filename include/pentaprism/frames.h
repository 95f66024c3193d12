#pragma once
// Lists of frames and the names of the files they go to.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pentaprism {

/// "1-48,60,100-150x4": ranges with both ends, single frames, ranges with a step, in the order given; a range whose
/// first frame is the larger one runs backwards. Frames are whole and not negative. Throws Error(kUsage) for anything
/// else, for a frame that is listed twice, and beyond a million frames.
std::vector<std::int64_t> parse_frames(const std::string& list);

/// True when the file's name (not its folder) holds a place for the frame number: one or more `#`.
bool has_frame_number(const std::filesystem::path& pattern);

/// The last run of `#` in the file's name replaced by the frame, padded with zeros to the number of `#`; a longer
/// number is written in full. Without `#` the pattern itself.
std::filesystem::path frame_file(const std::filesystem::path& pattern, std::int64_t frame);

}  // namespace pentaprism
