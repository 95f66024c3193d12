#pragma once
// `--resume`: what is on the disk may be kept if it was made with the settings of now.

#include <filesystem>
#include <pentaprism/image.h>

namespace pentaprism::cli {

/// Does nothing where there is no such file. Else throws Error(kUsage), with the first setting that differs, unless the
/// file's own header says that this program made it with these settings.
void check_made_with(const std::filesystem::path& file, const FileMetadata& now);

}  // namespace pentaprism::cli
