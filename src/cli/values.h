#pragma once
// Texts of the command line to values. Each throws Error(kUsage) that names the option, the text and what is wanted.

#include <cstdint>
#include <fmt/format.h>
#include <pentaprism/error.h>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pentaprism::cli {

std::int64_t parse_whole(const std::string& option, const std::string& text, std::int64_t least, std::int64_t most);
double parse_number(const std::string& option, const std::string& text);

/// `count` numbers with commas between them; `form` is how the help writes them ("R,G,B").
std::vector<double> parse_numbers(const std::string& option, const std::string& text, std::size_t count,
                                  const std::string& form);

/// The parts of a list with commas between them.
std::vector<std::string> split_list(const std::string& text);

/// "1280x720"
std::pair<int, int> parse_size(const std::string& option, const std::string& text);

/// One of a few names.
template <class T>
T parse_choice(const std::string& option, const std::string& text,
               const std::vector<std::pair<std::string, T>>& choices) {
    std::string names;
    for (const auto& [name, value] : choices) {
        if (name == text) return value;
        names += (names.empty() ? "" : ", ") + name;
    }
    throw Error(ErrorKind::kUsage, fmt::format("{}: '{}' is not one of {}", option, text, names));
}

}  // namespace pentaprism::cli
