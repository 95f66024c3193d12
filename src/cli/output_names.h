#pragma once
// What can be known of a failing output before hours of rendering is said before.

#include <filesystem>

namespace pentaprism::cli {

/// Throws Error(kOutput) if `file` could not be written; `option` is who asked for it.
void check_output_name(const std::filesystem::path& file, const char* option);

/// Throws Error(kUsage) if --output is no picture's name, or none of a file that holds output variables.
void check_picture_name(const std::filesystem::path& out, bool has_aovs);

}  // namespace pentaprism::cli
