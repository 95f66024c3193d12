#include "cli/values.h"

#include <charconv>
#include <limits>

namespace pentaprism::cli {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& text, const std::string& wanted) {
    throw Error(ErrorKind::kUsage, fmt::format("{}: '{}' is not {}", option, text, wanted));
}

// from_chars takes no leading +, no white space and no locale: what is written is what is meant.
template <class T>
bool parse_all(std::string_view text, T& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() && !text.empty();
}

}  // namespace

std::int64_t parse_whole(const std::string& option, const std::string& text, std::int64_t least, std::int64_t most) {
    std::int64_t value = 0;
    if (!parse_all(text, value) || value < least || value > most) {
        refuse(option, text, fmt::format("a whole number from {} to {}", least, most));
    }
    return value;
}

double parse_number(const std::string& option, const std::string& text) {
    double value = 0.0;
    if (!parse_all(text, value)) refuse(option, text, "a number");
    return value;
}

std::vector<double> parse_numbers(const std::string& option, const std::string& text, std::size_t count,
                                  const std::string& form) {
    std::vector<double> values;
    for (const std::string& part : split_list(text)) {
        double value = 0.0;
        if (!parse_all(part, value)) refuse(option, text, "of the form " + form);
        values.push_back(value);
    }
    if (values.size() != count) refuse(option, text, "of the form " + form);
    return values;
}

std::vector<std::string> split_list(const std::string& text) {
    std::vector<std::string> parts(1);
    for (const char c : text) {
        if (c == ',')
            parts.emplace_back();
        else
            parts.back() += c;
    }
    return parts;
}

std::pair<int, int> parse_size(const std::string& option, const std::string& text) {
    const std::size_t cross = text.find('x');
    int width = 0, height = 0;
    if (cross == std::string::npos || !parse_all(std::string_view(text).substr(0, cross), width) ||
        !parse_all(std::string_view(text).substr(cross + 1), height)) {
        refuse(option, text, "of the form WIDTHxHEIGHT, such as 1280x720");
    }
    return {width, height};
}

}  // namespace pentaprism::cli
