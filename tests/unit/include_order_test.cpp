// A folder of src/ is a stage; a stage may name the stages before it and none after. The order is that of
// src/CMakeLists.txt.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <optional>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Include {
    fs::path file;  // relative to the folder that was read
    int line;
    std::string target;
    bool quoted;  // "target", not <target>
};

std::vector<Include> includes_below(const fs::path& folder) {
    static const std::regex kInclude(R"re(^\s*#\s*include\s*(["<])([^">]+)[">])re");
    std::vector<Include> found;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
        const fs::path extension = entry.path().extension();
        if (extension != ".cpp" && extension != ".h") continue;
        std::ifstream in(entry.path());
        std::string line;
        std::smatch match;
        for (int number = 1; std::getline(in, line); ++number) {
            if (!std::regex_search(line, match, kInclude)) continue;
            found.push_back({fs::relative(entry.path(), folder), number, match[2], match[1] == "\""});
        }
    }
    return found;
}

std::vector<std::string> stages_in_order() {
    std::istringstream list(PENTAPRISM_STAGES);
    std::vector<std::string> stages;
    for (std::string stage; list >> stage;) stages.push_back(stage);
    stages.push_back("cli");
    return stages;
}

std::string first_folder(const fs::path& path) {
    return path.begin()->string();
}

std::optional<std::size_t> place_of(const std::string& stage, const std::vector<std::string>& stages) {
    const auto found = std::find(stages.begin(), stages.end(), stage);
    if (found == stages.end()) return std::nullopt;
    return static_cast<std::size_t>(found - stages.begin());
}

const fs::path kSource = fs::path(PENTAPRISM_SOURCE_DIR) / "src";
const fs::path kPublic = fs::path(PENTAPRISM_SOURCE_DIR) / "include";

TEST(IncludeOrder, NoStageIncludesALaterStage) {
    const std::vector<std::string> stages = stages_in_order();
    ASSERT_GE(stages.size(), 10u);
    const std::vector<Include> includes = includes_below(kSource);
    ASSERT_FALSE(includes.empty());
    for (const Include& include : includes) {
        const std::optional<std::size_t> from = place_of(first_folder(include.file), stages);
        const std::optional<std::size_t> to = place_of(first_folder(include.target), stages);
        ASSERT_TRUE(from) << "src/" << include.file.string()
                          << ": its folder is not in PENTAPRISM_STAGES of src/CMakeLists.txt";
        if (include.quoted) {
            EXPECT_TRUE(to) << "src/" << include.file.string() << ":" << include.line
                            << ": write \"stage/file.h\" for \"" << include.target
                            << "\", or <...> for what is not ours";
        }
        if (to) {
            EXPECT_LE(*to, *from) << "src/" << include.file.string() << ":" << include.line << ": " << include.target
                                  << " belongs to a later stage";
        }
    }
}

TEST(IncludeOrder, TheProgramKnowsThePublicHeadersOnly) {
    const std::vector<std::string> stages = stages_in_order();
    for (const Include& include : includes_below(kSource)) {
        if (first_folder(include.file) != "cli") continue;
        const std::string folder = first_folder(include.target);
        EXPECT_TRUE(folder == "cli" || !place_of(folder, stages))
            << "src/" << include.file.string() << ":" << include.line << ": " << include.target
            << " is inside the library";
    }
}

TEST(IncludeOrder, PublicHeadersIncludeNothingOfTheInside) {
    const std::vector<Include> includes = includes_below(kPublic);
    ASSERT_FALSE(includes.empty());
    for (const Include& include : includes) {
        EXPECT_FALSE(include.quoted) << "include/" << include.file.string() << ":" << include.line << ": "
                                     << include.target;
        const std::string folder = first_folder(include.target);
        const bool has_folder = fs::path(include.target).has_parent_path();
        EXPECT_TRUE(!has_folder || folder == "pentaprism" || folder == "glm")
            << "include/" << include.file.string() << ":" << include.line << ": " << include.target
            << " would have to be installed, too";
    }
}

}  // namespace
