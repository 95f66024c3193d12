#include <charconv>
#include <fmt/format.h>
#include <pentaprism/error.h>
#include <pentaprism/frames.h>
#include <string_view>
#include <unordered_set>

namespace pentaprism {
namespace {

constexpr std::int64_t kLargestFrame = 999'999'999;
constexpr std::size_t kMostFrames = 1'000'000;

[[noreturn]] void refuse(std::string_view list, std::string_view why) {
    throw Error(ErrorKind::kUsage, fmt::format("frames '{}': {}; write frames as 1-48,60,100-150x4", list, why));
}

/// Takes a whole number off the front of `text`.
std::int64_t take_number(std::string_view& text, std::string_view list) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_digit = !text.empty() && text.front() >= '0' && text.front() <= '9';
    if (!is_digit || error == std::errc::invalid_argument) refuse(list, "a frame is a whole number from 0 up");
    if (error != std::errc() || value > kLargestFrame)
        refuse(list, fmt::format("no frame is beyond {}", kLargestFrame));
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return value;
}

bool take(std::string_view& text, char sign) {
    if (text.empty() || text.front() != sign) return false;
    text.remove_prefix(1);
    return true;
}

struct Range {
    std::int64_t first, last, step;
};

Range parse_range(std::string_view text, std::string_view list) {
    Range range{take_number(text, list), 0, 1};
    range.last = take(text, '-') ? take_number(text, list) : range.first;
    if (take(text, 'x')) range.step = take_number(text, list);
    if (!text.empty()) refuse(list, fmt::format("'{}' is not understood", text));
    if (range.step < 1) refuse(list, "a step is 1 or more");
    return range;
}

}  // namespace

std::vector<std::int64_t> parse_frames(const std::string& list) {
    std::vector<std::int64_t> frames;
    std::unordered_set<std::int64_t> seen;
    std::string_view rest = list;
    for (bool more = true; more;) {
        const std::size_t comma = rest.find(',');
        more = comma != std::string_view::npos;
        const Range range = parse_range(rest.substr(0, comma), list);
        if (more) rest.remove_prefix(comma + 1);
        const std::int64_t step = range.last >= range.first ? range.step : -range.step;
        for (std::int64_t frame = range.first; step > 0 ? frame <= range.last : frame >= range.last; frame += step) {
            if (!seen.insert(frame).second) refuse(list, fmt::format("frame {} is listed twice", frame));
            if (frames.size() == kMostFrames) refuse(list, fmt::format("these are over {} frames", kMostFrames));
            frames.push_back(frame);
        }
    }
    return frames;
}

bool has_frame_number(const std::filesystem::path& pattern) {
    return pattern.filename().string().find('#') != std::string::npos;
}

std::filesystem::path frame_file(const std::filesystem::path& pattern, std::int64_t frame) {
    std::string name = pattern.filename().string();
    const std::size_t last = name.rfind('#');
    if (last == std::string::npos) return pattern;
    const std::size_t before = name.find_last_not_of('#', last);
    const std::size_t first = before == std::string::npos ? 0 : before + 1;
    const std::size_t width = last - first + 1;
    name.replace(first, width, fmt::format("{:0{}}", frame, width));
    return pattern.parent_path() / name;
}

}  // namespace pentaprism
