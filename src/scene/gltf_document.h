#pragma once
// A glTF file as it was read: its JSON, its buffers, and checked access to both. Every number, index and range that the
// readers of meshes, materials, nodes... use comes through here, so that a broken file ends in one message and never in
// a bad read.

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <pentaprism/scene.h>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace pentaprism::gltf {

using Json = nlohmann::json;

struct Document;

/// One JSON object and its place in the file, as messages name it ("accessor 12"). Getters return `fallback` for an
/// absent member and throw Error(kScene) for one of the wrong type or range.
class Object {
  public:
    Object(const Document& document, const Json& json, std::string where);

    bool has(const char* key) const { return json_->contains(key); }
    const Json& json() const { return *json_; }
    const std::string& where() const { return where_; }
    [[noreturn]] void fail(const std::string& what) const;

    std::int64_t integer(const char* key, std::int64_t fallback) const;
    std::int64_t required_integer(const char* key) const;
    /// A count, length or offset: not negative, below 2^48.
    std::size_t size(const char* key, std::size_t fallback) const;
    std::size_t required_size(const char* key) const;
    double number(const char* key, double fallback) const;
    bool boolean(const char* key, bool fallback) const;
    std::string text(const char* key, const std::string& fallback = "") const;
    /// The index of an existing element of the root array `list` ("meshes"); kNone when absent.
    Index index(const char* key, const char* list) const;
    /// Empty when absent; exactly `count` finite numbers otherwise (any number of them if count is 0).
    std::vector<double> numbers(const char* key, std::size_t count) const;
    /// An array of indices into the root array `list`; empty when absent.
    std::vector<Index> indices(const char* key, const char* list) const;
    /// The member as an object; throws when it is absent.
    Object child(const char* key) const;
    /// The members of an array of objects; empty when absent. Their place is "WHERE, NAME i".
    std::vector<Object> children(const char* key, const char* name) const;
    bool has_extension(const char* name) const;
    Object extension(const char* name) const;

  private:
    std::string place_of(const std::string& part) const;
    const Json* member(const char* key) const;
    const Document* document_;
    const Json* json_;
    std::string where_;
};

/// A buffer view after decompression. `bytes` is empty where the buffer is only a placeholder (no uri, no chunk): then
/// ranges can be checked but nothing can be read. `stride` is 0 where the file gives none: elements are tightly packed.
struct View {
    std::span<const std::uint8_t> bytes;
    std::size_t length = 0, stride = 0;
    bool absent() const { return bytes.empty(); }
};

struct Document {
    std::string name;              ///< file name, first in every message
    std::filesystem::path folder;  ///< where relative URIs start
    Json json;
    std::vector<std::uint8_t> binary_chunk;  ///< of a .glb
    bool is_binary = false, has_binary_chunk = false;
    struct Buffer {
        std::vector<std::uint8_t> bytes;  ///< empty for a placeholder
        std::size_t length = 0;
    };
    std::vector<Buffer> buffers;
    std::vector<std::vector<std::uint8_t>> decompressed;  ///< storage of the views that were compressed
    std::vector<View> views;
    std::vector<int> largest_joints;      ///< that vertices of each mesh name; kNone for a mesh without joints
    std::vector<Index> original_cameras;  ///< of each of Scene::cameras: which of the file's it is a copy of, or is
    std::vector<std::string> warnings;
    std::set<std::string> warned;
    mutable std::size_t decoded = 0;  ///< numbers read through accessors so far

    [[noreturn]] void fail(const std::string& what) const;
    /// Adds a warning, once.
    void warn(const std::string& what);
    /// Counts numbers that are about to be decoded or copied; throws when a file asks for absurdly many.
    void spend(std::size_t components) const;
    /// Number of elements of a root array, 0 when it is absent.
    std::size_t count(const char* list) const;
    /// Element i of a root array; its place is "NAME i". i must be below count(list).
    Object item(const char* list, const char* name, std::size_t i) const;
    Object root() const;
};

/// Reads the file and splits a .glb into its chunks.
void read_container(const std::filesystem::path& file, Document& document);
/// The bytes that a URI (relative path or data:) stands for, or an explanation of why there are none.
struct UriBytes {
    std::vector<std::uint8_t> bytes;
    std::string problem;  ///< empty: all is well
};
UriBytes read_uri(const Document& document, const std::string& uri);

/// Fills Document::buffers and ::views, decoding EXT_meshopt_compression.
void read_buffers(Document& document);

/// What an accessor must be, for check_accessor and read_floats.
struct Accessor {
    std::size_t count = 0;
    int components = 1;      ///< 1 to 4, or 4, 9, 16 for matrices
    int component_type = 0;  ///< 5120 to 5126
    bool normalized = false;
    std::string type;  ///< "VEC3"
    std::string where;
};

/// Checks every accessor against its buffer view, its view against its buffer, and sparse parts likewise.
void check_accessors(const Document& document);
Accessor describe_accessor(const Document& document, Index accessor);

/// All components of all elements as float: integers are converted, normalised ones to [0,1] or [-1,1].
std::vector<float> read_floats(const Document& document, Index accessor);
/// For indices and joints; throws if the accessor holds floats.
std::vector<std::uint32_t> read_integers(const Document& document, Index accessor);

/// Throws unless the accessor has one of the types ("VEC3"...).
void require_type(const Document& document, Index accessor, std::initializer_list<const char*> types,
                  const std::string& what);

inline bool all_finite(std::span<const float> values) {
    for (const float value : values) {
        if (!(value - value == 0.0f)) return false;
    }
    return true;
}

}  // namespace pentaprism::gltf
