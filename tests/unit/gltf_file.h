#pragma once
// Small glTF files made by tests: a JSON document whose one buffer lies beside it.

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <unistd.h>
#include <vector>

namespace pentaprism::test {

/// A folder of its own for each test, removed at the end.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        static int count = 0;
        path_ = std::filesystem::temp_directory_path() /
                ("pentaprism-scene-test-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path write(const std::string& name, const std::string& text) const {
        const auto file = path_ / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file, std::ios::binary) << text;
        return file;
    }

  private:
    std::filesystem::path path_;
};

/// Members of `json` may be changed at will before save().
class GltfFile {
  public:
    nlohmann::json json = {{"asset", {{"version", "2.0"}}}};

    /// Each call makes a buffer view and an accessor; the result is the accessor's index.
    int floats(const char* type, const std::vector<float>& values) { return accessor(type, 5126, values); }
    int bytes(const char* type, const std::vector<std::uint8_t>& values) { return accessor(type, 5121, values); }
    int shorts(const char* type, const std::vector<std::uint16_t>& values) { return accessor(type, 5123, values); }
    int words(const char* type, const std::vector<std::uint32_t>& values) { return accessor(type, 5125, values); }

    template <class T>
    int view(const std::vector<T>& values) {
        while (data_.size() % 4 != 0) data_.push_back('\0');
        const std::size_t offset = data_.size(), length = values.size() * sizeof(T);
        data_.append(reinterpret_cast<const char*>(values.data()), length);
        json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", length}});
        return static_cast<int>(json["bufferViews"].size()) - 1;
    }

    template <class T>
    int accessor(const std::string& type, int component_type, const std::vector<T>& values) {
        const std::size_t width = type == "SCALAR" ? 1 : type == "MAT4" ? 16 : static_cast<std::size_t>(type[3] - '0');
        json["accessors"].push_back({{"bufferView", view(values)},
                                     {"componentType", component_type},
                                     {"count", values.size() / width},
                                     {"type", type}});
        return static_cast<int>(json["accessors"].size()) - 1;
    }

    /// A mesh of one primitive with these attributes; the result is the primitive, for more to be added.
    nlohmann::json& mesh(const nlohmann::json& attributes) {
        json["meshes"].push_back({{"primitives", {{{"attributes", attributes}}}}});
        return json["meshes"].back()["primitives"][0];
    }

    int node(const nlohmann::json& node) {
        json["nodes"].push_back(node);
        return static_cast<int>(json["nodes"].size()) - 1;
    }

    /// A node with mesh 0: a triangle with corners (0,0,0), (1,0,0), (0,1,0).
    void triangle() {
        mesh({{"POSITION", floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})}});
        node({{"mesh", 0}});
    }

    std::filesystem::path save(const TemporaryFolder& folder, const std::string& name = "test.gltf") {
        if (!data_.empty()) {
            json["buffers"] = {{{"uri", "test.bin"}, {"byteLength", data_.size()}}};
            folder.write("test.bin", data_);
        }
        return folder.write(name, json.dump());
    }

  private:
    std::string data_;
};

}  // namespace pentaprism::test
