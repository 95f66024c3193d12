#pragma once
// What the program says: errors and warnings on stderr, one line each; results on stdout.

#include <string>
#include <vector>

namespace pentaprism::cli {

enum class LogLevel { kError, kWarning, kInfo, kDebug };
void set_log_level(LogLevel level);

void print_error(const std::string& message);
void print_warning(const std::string& message);
void print_info(const std::string& message);
void print_debug(const std::string& message);

/// A line on the terminal that the next message must not be glued to; it is wiped before anything is printed.
void set_status_line(const std::string& line);

/// To stdout. Throws Error(kOutput) when it cannot be written, a full disk included.
void print_result(const std::string& text);

/// Control characters, as a hostile file name may hold them, become `?`: a message stays one line.
std::string one_line(const std::string& text);

}  // namespace pentaprism::cli
