// Documents may only point to what exists.
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path kProject = PENTAPRISM_SOURCE_DIR;

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Files with one of these extensions in the given folders of the project (recursively) and beside them in its top
/// folder.
std::vector<fs::path> project_files(const std::vector<std::string>& folders,
                                    const std::vector<std::string>& extensions) {
    const auto wanted = [&](const fs::path& path) {
        for (const std::string& extension : extensions) {
            if (path.extension() == extension) return true;
        }
        return false;
    };
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(kProject)) {
        if (entry.is_regular_file() && wanted(entry.path())) files.push_back(entry.path());
    }
    for (const std::string& folder : folders) {
        if (!fs::exists(kProject / folder)) continue;
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kProject / folder)) {
            if (entry.is_regular_file() && wanted(entry.path())) files.push_back(entry.path());
        }
    }
    return files;
}

TEST(Documents, EveryRelativeLinkLeadsToAFile) {
    static const std::regex kLink(R"re(\]\(([^)#\s]+)(#[^)]*)?\))re");
    int links = 0;
    for (const fs::path& file : project_files({"docs", "examples"}, {".md"})) {
        const std::string text = text_of(file);
        for (std::sregex_iterator match(text.begin(), text.end(), kLink), end; match != end; ++match) {
            const std::string target = (*match)[1];
            if (target.find("://") != std::string::npos) continue;
            ++links;
            EXPECT_TRUE(fs::exists(file.parent_path() / target))
                << fs::relative(file, kProject) << " links to " << target;
        }
    }
    EXPECT_GT(links, 10);
}

TEST(Documents, EveryDocumentThatSourcesNameExists) {
    static const std::regex kDocument(R"re(\bdocs/[A-Za-z0-9_/-]+\.md\b)re");
    int names = 0;
    const std::vector<std::string> folders = {"src", "include", "cmake", "tests", "packaging", "scripts"};
    for (const fs::path& file : project_files(folders, {".cpp", ".h", ".cmake", ".txt", ".sh"})) {
        const std::string text = text_of(file);
        for (std::sregex_iterator match(text.begin(), text.end(), kDocument), end; match != end; ++match) {
            ++names;
            EXPECT_TRUE(fs::exists(kProject / match->str()))
                << fs::relative(file, kProject) << " names " << match->str();
        }
    }
    EXPECT_GT(names, 2);
}

}  // namespace
