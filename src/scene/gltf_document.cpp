#include "scene/gltf_document.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <pentaprism/error.h>

namespace pentaprism::gltf {

namespace {

constexpr const char* kRootPlace = "the file";
constexpr std::size_t kLargestSize = std::size_t{1} << 48;

constexpr std::size_t kMostWarnings = 100;
/// Numbers that all accessors together may become: a small file can name the same large accessor a million times. Many
/// primitives sharing one vertex buffer are common, hence the factor.
constexpr std::size_t kFreeComponents = std::size_t{1} << 26;
constexpr std::size_t kComponentsPerByte = 64;

}  // namespace

void Document::fail(const std::string& what) const {
    throw Error(ErrorKind::kScene, name + ": " + what);
}

void Document::warn(const std::string& what) {
    if (!warned.insert(what).second) return;
    if (warned.size() < kMostWarnings) warnings.push_back(name + ": " + what);
    if (warned.size() == kMostWarnings) warnings.push_back(name + ": more warnings are left out");
}

void Document::spend(std::size_t components) const {
    decoded += components;
    std::size_t bytes = 0;
    for (const Buffer& buffer : buffers) bytes += buffer.bytes.size();
    if (decoded > kFreeComponents + kComponentsPerByte * bytes) {
        fail("holds more data than can be read (the same accessors are used too often)");
    }
}

std::size_t Document::count(const char* list) const {
    const auto found = json.find(list);
    if (found == json.end()) return 0;
    if (!found->is_array()) fail(fmt::format("\"{}\" is not an array", list));
    return found->size();
}

Object Document::item(const char* list, const char* name, std::size_t i) const {
    return {*this, json.at(list).at(i), fmt::format("{} {}", name, i)};
}

Object Document::root() const {
    return {*this, json, kRootPlace};
}

Object::Object(const Document& document, const Json& json, std::string where)
    : document_(&document), json_(&json), where_(std::move(where)) {
    if (!json.is_object()) fail("is not a JSON object");
}

void Object::fail(const std::string& what) const {
    document_->fail(where_ + " " + what);
}

const Json* Object::member(const char* key) const {
    const auto found = json_->find(key);
    return found == json_->end() ? nullptr : &*found;
}

std::int64_t Object::integer(const char* key, std::int64_t fallback) const {
    const Json* value = member(key);
    if (value == nullptr) return fallback;
    if (value->is_number_unsigned() && value->get<std::uint64_t>() > kLargestSize)
        fail(fmt::format("has a {} that is too large", key));
    if (value->is_number_integer()) return value->get<std::int64_t>();
    if (value->is_number_float()) {
        const double number = value->get<double>();
        if (number == std::floor(number) && std::abs(number) < double(kLargestSize))
            return static_cast<std::int64_t>(number);
    }
    fail(fmt::format("has a {} that is not an integer", key));
}

std::int64_t Object::required_integer(const char* key) const {
    if (!has(key)) fail(fmt::format("has no {}", key));
    return integer(key, 0);
}

std::size_t Object::size(const char* key, std::size_t fallback) const {
    const std::int64_t value = integer(key, static_cast<std::int64_t>(fallback));
    if (value < 0 || static_cast<std::size_t>(value) >= kLargestSize) fail(fmt::format("has a {} of {}", key, value));
    return static_cast<std::size_t>(value);
}

std::size_t Object::required_size(const char* key) const {
    if (!has(key)) fail(fmt::format("has no {}", key));
    return size(key, 0);
}

double Object::number(const char* key, double fallback) const {
    const Json* value = member(key);
    if (value == nullptr) return fallback;
    if (!value->is_number()) fail(fmt::format("has a {} that is not a number", key));
    const double number = value->get<double>();
    if (!std::isfinite(number)) fail(fmt::format("has a {} that is not finite", key));
    return number;
}

bool Object::boolean(const char* key, bool fallback) const {
    const Json* value = member(key);
    if (value == nullptr) return fallback;
    if (!value->is_boolean()) fail(fmt::format("has a {} that is neither true nor false", key));
    return value->get<bool>();
}

std::string Object::text(const char* key, const std::string& fallback) const {
    const Json* value = member(key);
    if (value == nullptr) return fallback;
    if (!value->is_string()) fail(fmt::format("has a {} that is not a string", key));
    return value->get<std::string>();
}

Index Object::index(const char* key, const char* list) const {
    if (!has(key)) return kNone;
    const std::int64_t value = integer(key, 0);
    const std::size_t count = document_->count(list);
    if (value < 0 || static_cast<std::size_t>(value) >= count)
        fail(fmt::format("refers to {} {}, but there are {} {}", key, value, count, list));
    return static_cast<Index>(value);
}

std::vector<double> Object::numbers(const char* key, std::size_t count) const {
    const Json* value = member(key);
    if (value == nullptr) return {};
    if (!value->is_array()) fail(fmt::format("has a {} that is not an array", key));
    if (count != 0 && value->size() != count)
        fail(fmt::format("has a {} of {} numbers instead of {}", key, value->size(), count));
    std::vector<double> numbers;
    numbers.reserve(value->size());
    for (const Json& entry : *value) {
        if (!entry.is_number()) fail(fmt::format("has a {} with an entry that is not a number", key));
        numbers.push_back(entry.get<double>());
        if (!std::isfinite(numbers.back())) fail(fmt::format("has a {} with an entry that is not finite", key));
    }
    return numbers;
}

std::vector<Index> Object::indices(const char* key, const char* list) const {
    const std::size_t count = document_->count(list);
    std::vector<Index> result;
    for (const double value : numbers(key, 0)) {
        if (!(value >= 0.0) || value >= double(count) || value != std::floor(value)) {
            fail(fmt::format("refers to {} {}, but there are {}", list, value, count));
        }
        result.push_back(static_cast<Index>(value));
    }
    return result;
}

std::string Object::place_of(const std::string& part) const {
    return where_ == kRootPlace ? part : where_ + ", " + part;
}

Object Object::child(const char* key) const {
    const Json* value = member(key);
    if (value == nullptr) fail(fmt::format("has no {}", key));
    return {*document_, *value, place_of(key)};
}

std::vector<Object> Object::children(const char* key, const char* name) const {
    const Json* value = member(key);
    if (value == nullptr) return {};
    if (!value->is_array()) fail(fmt::format("has a {} that is not an array", key));
    std::vector<Object> result;
    for (std::size_t i = 0; i < value->size(); ++i) {
        result.emplace_back(*document_, (*value)[i], place_of(fmt::format("{} {}", name, i)));
    }
    return result;
}

bool Object::has_extension(const char* name) const {
    const Json* extensions = member("extensions");
    if (extensions == nullptr) return false;
    if (!extensions->is_object()) fail("has extensions that are not an object");
    return extensions->contains(name);
}

Object Object::extension(const char* name) const {
    return {*document_, json_->at("extensions").at(name), place_of(name)};
}

}  // namespace pentaprism::gltf
