// Accessors (glTF 2.0, 3.6.2): typed, strided, sparse, normalised views of buffer data.

#include <algorithm>
#include <cstring>
#include <fmt/format.h>

#include "scene/gltf_document.h"

namespace pentaprism::gltf {

namespace {

enum ComponentType { kByte = 5120, kUnsignedByte, kShort, kUnsignedShort, kUnsignedInt = 5125, kFloat };

/// Accessors without a buffer view are zeros: nothing in the file bounds their size, so we do.
constexpr std::size_t kMostZeros = std::size_t{1} << 24;

std::size_t component_size(int type) {
    switch (type) {
        case kByte:
        case kUnsignedByte:
            return 1;
        case kShort:
        case kUnsignedShort:
            return 2;
        case kUnsignedInt:
        case kFloat:
            return 4;
        default:
            return 0;
    }
}

int component_count(const std::string& type) {
    static constexpr std::pair<const char*, int> kTypes[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                             {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
    for (const auto& [name, count] : kTypes) {
        if (type == name) return count;
    }
    return 0;
}

/// Byte offsets of an element's components: columns of matrices start at multiples of four bytes.
struct ElementLayout {
    std::array<std::size_t, 16> offsets{};
    std::size_t size = 0;
};

ElementLayout element_layout(const Accessor& accessor) {
    ElementLayout layout;
    const std::size_t bytes = component_size(accessor.component_type);
    const bool matrix = accessor.type.starts_with("MAT");
    const std::size_t rows =
        matrix ? static_cast<std::size_t>(accessor.type[3] - '0') : static_cast<std::size_t>(accessor.components);
    const std::size_t column = matrix ? (rows * bytes + 3) / 4 * 4 : rows * bytes;
    for (std::size_t i = 0; i < static_cast<std::size_t>(accessor.components); ++i) {
        layout.offsets[i] = i / rows * column + i % rows * bytes;
    }
    layout.size =
        (static_cast<std::size_t>(accessor.components) / rows - 1) * column + (matrix ? column : rows * bytes);
    return layout;
}

/// `count` elements in a buffer view, proved to lie within it.
struct Elements {
    const std::uint8_t* first = nullptr;  ///< null: all zeros, or absent
    std::size_t stride = 0, count = 0;
    bool absent = false;  ///< the buffer has no data
};

Elements elements_in(const Document& document, const Object& place, Index view, std::size_t offset, std::size_t count,
                     std::size_t size, bool may_stride) {
    const View& bytes = document.views[static_cast<std::size_t>(view)];
    const std::size_t stride = may_stride && bytes.stride != 0 ? bytes.stride : size;
    if (stride < size && count > 1)
        place.fail(fmt::format("has elements of {} bytes in a buffer view with a stride of {}", size, stride));
    const std::size_t end = count == 0 ? 0 : offset + (count - 1) * stride + size;
    if (count > bytes.length || offset > bytes.length || end > bytes.length) {
        place.fail(fmt::format("reads past its buffer view (byte {} of {})", end, bytes.length));
    }
    return {bytes.absent() ? nullptr : bytes.bytes.data() + offset, stride, count, bytes.absent()};
}

Object accessor_object(const Document& document, Index accessor) {
    return document.item("accessors", "accessor", static_cast<std::size_t>(accessor));
}

Accessor describe(const Object& object) {
    Accessor accessor;
    accessor.where = object.where();
    accessor.count = object.required_size("count");
    if (accessor.count == 0) object.fail("has a count of 0");
    const std::int64_t type = object.required_integer("componentType");
    accessor.component_type = type >= kByte && type <= kFloat ? static_cast<int>(type) : 0;
    if (component_size(accessor.component_type) == 0) object.fail(fmt::format("has an unknown componentType {}", type));
    if (!object.has("type")) object.fail("has no type");
    accessor.type = object.text("type");
    accessor.components = component_count(accessor.type);
    if (accessor.components == 0) object.fail(fmt::format("has an unknown type \"{}\"", accessor.type));
    accessor.normalized = object.boolean("normalized", false);
    return accessor;
}

Elements base_elements(const Document& document, const Object& object, const Accessor& accessor) {
    const Index view = object.index("bufferView", "bufferViews");
    const std::size_t offset = object.size("byteOffset", 0);
    if (view == kNone) {
        if (accessor.count > kMostZeros)
            object.fail(fmt::format("has {} elements but no buffer view to hold them", accessor.count));
        return {nullptr, 0, accessor.count, false};
    }
    return elements_in(document, object, view, offset, accessor.count, element_layout(accessor).size, true);
}

struct SparsePart {
    Elements indices, values;
    int index_type = kUnsignedInt;
};

std::uint32_t integer_at(const std::uint8_t* bytes, int type) {
    switch (type) {
        case kByte:
            return static_cast<std::uint32_t>(static_cast<std::int8_t>(*bytes));
        case kUnsignedByte:
            return *bytes;
        case kShort:
        case kUnsignedShort: {
            std::uint16_t value;
            std::memcpy(&value, bytes, 2);
            return type == kShort ? static_cast<std::uint32_t>(static_cast<std::int16_t>(value)) : value;
        }
        default: {
            std::uint32_t value;
            std::memcpy(&value, bytes, 4);
            return value;
        }
    }
}

SparsePart sparse_part(const Document& document, const Object& object, const Accessor& accessor) {
    const Object sparse = object.child("sparse");
    const std::size_t count = sparse.required_size("count");
    if (count == 0 || count > accessor.count)
        sparse.fail(fmt::format("has a count of {} in an accessor of {}", count, accessor.count));
    const Object indices = sparse.child("indices"), values = sparse.child("values");
    SparsePart part;
    part.index_type = static_cast<int>(indices.required_integer("componentType"));
    if (part.index_type != kUnsignedByte && part.index_type != kUnsignedShort && part.index_type != kUnsignedInt) {
        indices.fail(fmt::format("has an unusable componentType {}", part.index_type));
    }
    if (!indices.has("bufferView")) indices.fail("has no bufferView");
    if (!values.has("bufferView")) values.fail("has no bufferView");
    part.indices = elements_in(document, indices, indices.index("bufferView", "bufferViews"),
                               indices.size("byteOffset", 0), count, component_size(part.index_type), false);
    part.values = elements_in(document, values, values.index("bufferView", "bufferViews"), values.size("byteOffset", 0),
                              count, element_layout(accessor).size, false);
    if (part.indices.absent || part.values.absent) return part;
    std::int64_t last = -1;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t at = integer_at(part.indices.first + i * part.indices.stride, part.index_type);
        if (at >= accessor.count) indices.fail(fmt::format("names element {} of {}", at, accessor.count));
        if (std::int64_t(at) <= last) indices.fail("are not in ascending order");
        last = at;
    }
    return part;
}

float float_at(const std::uint8_t* bytes, int type, bool normalized) {
    switch (type) {
        case kFloat: {
            float value;
            std::memcpy(&value, bytes, 4);
            return value;
        }
        case kByte: {
            const float value = static_cast<std::int8_t>(*bytes);
            return normalized ? std::max(value / 127.0f, -1.0f) : value;
        }
        case kShort: {
            const float value = static_cast<std::int16_t>(integer_at(bytes, kShort));
            return normalized ? std::max(value / 32767.0f, -1.0f) : value;
        }
        case kUnsignedByte:
            return normalized ? *bytes / 255.0f : *bytes;
        case kUnsignedShort: {
            const float value = static_cast<float>(integer_at(bytes, kUnsignedShort));
            return normalized ? value / 65535.0f : value;
        }
        default:
            return static_cast<float>(integer_at(bytes, kUnsignedInt));
    }
}

/// Calls store(index in the output, bytes of the component) for all components, sparse replacements last.
template <class Store>
void for_each_component(const Document& document, Index index, const Accessor& accessor, Store store) {
    const Object object = accessor_object(document, index);
    const ElementLayout layout = element_layout(accessor);
    const std::size_t components = static_cast<std::size_t>(accessor.components);
    const Elements base = base_elements(document, object, accessor);
    if (base.absent) object.fail("is in a buffer without data");
    const auto element = [&](std::size_t to, const std::uint8_t* from) {
        for (std::size_t c = 0; c < components; ++c) store(to * components + c, from + layout.offsets[c]);
    };
    if (base.first != nullptr) {
        for (std::size_t i = 0; i < base.count; ++i) element(i, base.first + i * base.stride);
    }
    if (!object.has("sparse")) return;
    const SparsePart part = sparse_part(document, object, accessor);
    if (part.indices.absent || part.values.absent) object.fail("is in a buffer without data");
    for (std::size_t i = 0; i < part.indices.count; ++i) {
        element(integer_at(part.indices.first + i * part.indices.stride, part.index_type),
                part.values.first + i * part.values.stride);
    }
}

}  // namespace

Accessor describe_accessor(const Document& document, Index accessor) {
    return describe(accessor_object(document, accessor));
}

void check_accessors(const Document& document) {
    for (std::size_t i = 0; i < document.count("accessors"); ++i) {
        const Object object = accessor_object(document, static_cast<Index>(i));
        const Accessor accessor = describe(object);
        base_elements(document, object, accessor);
        if (object.has("sparse")) sparse_part(document, object, accessor);
    }
}

std::vector<float> read_floats(const Document& document, Index index) {
    const Accessor accessor = describe_accessor(document, index);
    document.spend(accessor.count * static_cast<std::size_t>(accessor.components));
    std::vector<float> values(accessor.count * static_cast<std::size_t>(accessor.components));
    const int type = accessor.component_type;
    const bool normalized = accessor.normalized;
    for_each_component(document, index, accessor, [&](std::size_t to, const std::uint8_t* from) {
        values[to] = float_at(from, type, normalized);
    });
    return values;
}

std::vector<std::uint32_t> read_integers(const Document& document, Index index) {
    const Accessor accessor = describe_accessor(document, index);
    const int type = accessor.component_type;
    if (type == kFloat) document.fail(accessor.where + " holds floats where integers are needed");
    document.spend(accessor.count * static_cast<std::size_t>(accessor.components));
    std::vector<std::uint32_t> values(accessor.count * static_cast<std::size_t>(accessor.components));
    for_each_component(document, index, accessor,
                       [&](std::size_t to, const std::uint8_t* from) { values[to] = integer_at(from, type); });
    return values;
}

void require_type(const Document& document, Index index, std::initializer_list<const char*> types,
                  const std::string& what) {
    const Accessor accessor = describe_accessor(document, index);
    if (std::any_of(types.begin(), types.end(), [&](const char* type) { return accessor.type == type; })) return;
    document.fail(fmt::format("{} uses {}, which is {}", what, accessor.where, accessor.type));
}

}  // namespace pentaprism::gltf
