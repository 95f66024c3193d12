#include "cli/output_names.h"

#include <fmt/format.h>
#include <pentaprism/error.h>
#include <pentaprism/image.h>
#include <unistd.h>

namespace pentaprism::cli {

namespace fs = std::filesystem;

void check_output_name(const fs::path& file, const char* option) {
    std::error_code ignored;
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    const auto refuse = [&](const std::string& why) {
        throw Error(ErrorKind::kOutput, fmt::format("{} {}: cannot write ({})", option, file.string(), why));
    };
    if (!fs::exists(folder, ignored))
        refuse(fmt::format("the folder {} does not exist; make it first", folder.string()));
    if (!fs::is_directory(folder, ignored)) refuse(fmt::format("{} is not a folder", folder.string()));
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        refuse(fmt::format("the folder {} cannot be written to", folder.string()));
    if (fs::is_directory(file, ignored)) refuse("it is a folder");
    if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored)) refuse("it is no ordinary file");
}

void check_picture_name(const fs::path& out, bool has_aovs) {
    if (!is_picture_name(out))
        throw Error(ErrorKind::kUsage, fmt::format("--output {}: the name must end in .exr or .png", out.string()));
    if (has_aovs && !is_exr_name(out))
        throw Error(ErrorKind::kUsage,
                    fmt::format("--aov: only .exr files hold more than a picture, not {}", out.string()));
}

}  // namespace pentaprism::cli
