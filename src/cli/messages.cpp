#include "cli/messages.h"

#include <cerrno>
#include <cstdio>
#include <fmt/format.h>
#include <pentaprism/error.h>
#include <system_error>

namespace pentaprism::cli {
namespace {

LogLevel log_level = LogLevel::kWarning;
std::string status_line;

void print_line(const char* what, const std::string& message) {
    const std::string wipe = status_line.empty() ? "" : "\r\033[K";
    status_line.clear();
    // One call for one line, so that lines of several processes do not mix.
    const std::string line = fmt::format("{}pentaprism: {}: {}\n", wipe, what, one_line(message));
    std::fwrite(line.data(), 1, line.size(), stderr);
}

}  // namespace

std::string one_line(const std::string& text) {
    std::string line = text;
    for (char& c : line) {
        const auto code = static_cast<unsigned char>(c);
        if (code < 0x20 || code == 0x7f) c = c == '\n' || c == '\t' ? ' ' : '?';
    }
    return line;
}

void set_log_level(LogLevel level) {
    log_level = level;
}

void print_error(const std::string& message) {
    print_line("error", message);
}
void print_warning(const std::string& message) {
    if (log_level >= LogLevel::kWarning) print_line("warning", message);
}
void print_info(const std::string& message) {
    if (log_level >= LogLevel::kInfo) print_line("info", message);
}
void print_debug(const std::string& message) {
    if (log_level >= LogLevel::kDebug) print_line("debug", message);
}

void set_status_line(const std::string& line) {
    if (line.empty() && status_line.empty()) return;
    status_line = line;
    const std::string text = "\r" + line + "\033[K";
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

void print_result(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
        throw Error(ErrorKind::kOutput,
                    fmt::format("standard output: cannot write ({})", std::generic_category().message(errno)));
    }
}

}  // namespace pentaprism::cli
