// KHR_draco_mesh_compression
// (https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Khronos/KHR_draco_mesh_compression).

#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>
#include <fmt/format.h>

#include "scene/gltf_parts.h"

namespace pentaprism::gltf {

namespace {

/// One attribute at all points. Normalised integers become floats when the accessor says so, as outside Draco.
DracoMesh::Attribute read_attribute(const Object& extension, const draco::Mesh& mesh,
                                    const draco::PointAttribute& source, std::string name, const Accessor& accessor) {
    DracoMesh::Attribute attribute;
    attribute.name = std::move(name);
    attribute.components = source.num_components();
    const auto width = static_cast<std::size_t>(attribute.components);
    if (width == 0 || width > 4) extension.fail(fmt::format("has a {} of {} components", attribute.name, width));
    const std::size_t points = mesh.num_points();
    const bool joints = attribute.name.starts_with("JOINTS");
    float scale = 1.0f;
    if (accessor.normalized) {
        switch (accessor.component_type) {
            case 5120:
                scale = 127.0f;
                break;
            case 5121:
                scale = 255.0f;
                break;
            case 5122:
                scale = 32767.0f;
                break;
            case 5123:
                scale = 65535.0f;
                break;
            default:
                break;
        }
    }
    // Draco normalises by itself where the attribute is marked so.
    if (source.normalized() && source.data_type() != draco::DT_FLOAT32) scale = 1.0f;
    (joints ? attribute.integers.resize(points * width) : attribute.values.resize(points * width));
    for (std::size_t i = 0; i < points; ++i) {
        const auto index = source.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
        if (index.value() >= source.size()) extension.fail(fmt::format("has a {} that is cut off", attribute.name));
        bool done;
        if (joints) {
            std::uint32_t values[4] = {};
            done = source.ConvertValue<std::uint32_t>(index, static_cast<std::int8_t>(width), values);
            for (std::size_t k = 0; k < width; ++k) attribute.integers[i * width + k] = values[k];
        } else {
            float values[4] = {};
            done = source.ConvertValue<float>(index, static_cast<std::int8_t>(width), values);
            for (std::size_t k = 0; k < width; ++k) attribute.values[i * width + k] = values[k] / scale;
        }
        if (!done) extension.fail(fmt::format("has a {} that cannot be converted", attribute.name));
    }
    return attribute;
}

}  // namespace

DracoMesh decode_draco(const Document& document, const Object& primitive) {
    const Object extension = primitive.extension("KHR_draco_mesh_compression");
    if (!extension.has("bufferView")) extension.fail("has no bufferView");
    const View& view = document.views[static_cast<std::size_t>(extension.index("bufferView", "bufferViews"))];
    if (view.absent()) extension.fail("is in a buffer without data");
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(view.bytes.data()), view.bytes.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) extension.fail(fmt::format("cannot be decoded: {}", decoded.status().error_msg_string()));
    const draco::Mesh& mesh = *decoded.value();

    DracoMesh result;
    result.vertex_count = mesh.num_points();
    document.spend((result.vertex_count + mesh.num_faces()) * 4);
    const Object ids = extension.child("attributes"), attributes = primitive.child("attributes");
    for (const auto& [name, unused] : ids.json().items()) {
        const std::size_t id = ids.size(name.c_str(), 0);
        const Index accessor = attributes.index(name.c_str(), "accessors");
        if (accessor == kNone) extension.fail(fmt::format("has a {} that the primitive has not", name));
        const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
        if (attribute == nullptr) extension.fail(fmt::format("has no attribute {} for {}", id, name));
        result.attributes.push_back(
            read_attribute(extension, mesh, *attribute, name, describe_accessor(document, accessor)));
    }
    result.indices.reserve(std::size_t{mesh.num_faces()} * 3);
    for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face) {
        for (const draco::PointIndex& corner : mesh.face(face)) {
            if (corner.value() >= mesh.num_points()) extension.fail("has a triangle with a vertex that does not exist");
            result.indices.push_back(corner.value());
        }
    }
    return result;
}

}  // namespace pentaprism::gltf
