// Meshes (glTF 2.0, 3.7.2): triangles in all their modes, attributes, skin influences, morph targets.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "scene/gltf_parts.h"
#include "scene/mesh_repair.h"

namespace pentaprism::gltf {

namespace {

enum Mode { kPoints, kLines, kLineLoop, kLineStrip, kTriangles, kTriangleStrip, kTriangleFan };

/// One primitive while it is read: where its attributes come from, and how many vertices it has.
struct Source {
    Document& document;
    const Object& object;  ///< the primitive
    const Object attributes;
    const DracoMesh* draco;  ///< null: not compressed
    std::size_t vertex_count = 0;

    const DracoMesh::Attribute* compressed(const std::string& name) const {
        if (draco == nullptr) return nullptr;
        for (const auto& attribute : draco->attributes) {
            if (attribute.name == name) return &attribute;
        }
        return nullptr;
    }
};

template <int kWidth>
std::vector<glm::vec<kWidth, float>> as_vectors(const std::vector<float>& values) {
    std::vector<glm::vec<kWidth, float>> vectors(values.size() / kWidth);
    for (std::size_t i = 0; i < vectors.size(); ++i) {
        for (int k = 0; k < kWidth; ++k) vectors[i][k] = values[i * kWidth + static_cast<std::size_t>(k)];
    }
    return vectors;
}

void require_count(const Source& source, const std::string& name, std::size_t count) {
    if (count == source.vertex_count) return;
    source.object.fail(fmt::format("has {} {} for {} vertices", count, name, source.vertex_count));
}

/// Components of an attribute with as many entries as there are vertices; empty when the primitive has none of this
/// name.
std::vector<float> attribute_floats(const Source& source, const char* name, std::initializer_list<const char*> types) {
    if (!source.attributes.has(name)) return {};
    const Index accessor = source.attributes.index(name, "accessors");
    require_type(source.document, accessor, types, fmt::format("{}, {},", source.object.where(), name));
    const auto components = static_cast<std::size_t>(describe_accessor(source.document, accessor).components);
    std::vector<float> values;
    if (const auto* compressed = source.compressed(name)) {
        if (static_cast<std::size_t>(compressed->components) != components) {
            source.object.fail(
                fmt::format("has a {} whose compressed data has {} components", name, compressed->components));
        }
        values = compressed->values;
    } else {
        require_count(source, name, describe_accessor(source.document, accessor).count);
        values = read_floats(source.document, accessor);
    }
    require_count(source, name, values.size() / components);
    return values;
}

/// Attributes of looks only: a picture without them still makes sense.
void zero_if_not_finite(const Source& source, const char* name, std::vector<float>& values) {
    if (all_finite(values)) return;
    source.document.warn(
        fmt::format("{} has a {} that is not finite; zero is used there", source.object.where(), name));
    for (float& value : values) {
        if (!std::isfinite(value)) value = 0.0f;
    }
}

void read_positions(Source& source, Primitive& primitive) {
    const Index accessor = source.attributes.index("POSITION", "accessors");
    source.vertex_count = source.draco != nullptr && source.compressed("POSITION") != nullptr
                              ? source.draco->vertex_count
                              : describe_accessor(source.document, accessor).count;
    const std::vector<float> values = attribute_floats(source, "POSITION", {"VEC3"});
    if (!all_finite(values)) source.object.fail("has a POSITION that is not finite");
    primitive.positions = as_vectors<3>(values);
}

void read_normals(Source& source, Primitive& primitive) {
    std::vector<float> values = attribute_floats(source, "NORMAL", {"VEC3"});
    if (values.empty()) return;
    primitive.normals = as_vectors<3>(values);
    std::vector<glm::vec3> substitutes;
    for (std::size_t i = 0; i < primitive.normals.size(); ++i) {
        const glm::dvec3 normal = primitive.normals[i];
        const double length = glm::length(normal);
        if (std::isfinite(length) && length > 1e-6) {
            primitive.normals[i] = glm::vec3(normal / length);
            continue;
        }
        if (substitutes.empty()) {
            substitutes = smooth_normals(primitive.positions, primitive.indices);
            source.document.warn(source.object.where() +
                                 " has normals without a direction; the surface's own are used there");
        }
        primitive.normals[i] = substitutes[i];
    }
}

void read_tangents(Source& source, Primitive& primitive) {
    std::vector<float> values = attribute_floats(source, "TANGENT", {"VEC4"});
    zero_if_not_finite(source, "TANGENT", values);
    primitive.tangents = as_vectors<4>(values);
    for (glm::vec4& tangent : primitive.tangents) tangent.w = tangent.w < 0.0f ? -1.0f : 1.0f;
}

void read_colors(Source& source, Primitive& primitive) {
    if (!source.attributes.has("COLOR_0")) return;
    std::vector<float> values = attribute_floats(source, "COLOR_0", {"VEC3", "VEC4"});
    zero_if_not_finite(source, "COLOR_0", values);
    if (values.size() == primitive.positions.size() * 4) {
        primitive.colors = as_vectors<4>(values);
        return;
    }
    for (const glm::vec3& color : as_vectors<3>(values)) primitive.colors.emplace_back(color, 1.0f);
}

void read_texcoords(Source& source, Primitive& primitive) {
    static constexpr std::array<const char*, 2> kNames = {"TEXCOORD_0", "TEXCOORD_1"};
    for (std::size_t set = 0; set < kNames.size(); ++set) {
        std::vector<float> values = attribute_floats(source, kNames[set], {"VEC2"});
        zero_if_not_finite(source, kNames[set], values);
        primitive.texcoords[set] = as_vectors<2>(values);
    }
    if (source.attributes.has("TEXCOORD_2")) {
        source.document.warn(source.object.where() +
                             " has more than two sets of texture coordinates; only the first two are used");
    }
}

std::vector<std::uint32_t> joint_numbers(const Source& source, const char* name) {
    const Index accessor = source.attributes.index(name, "accessors");
    require_type(source.document, accessor, {"VEC4"}, fmt::format("{}, {},", source.object.where(), name));
    const auto* compressed = source.compressed(name);
    if (compressed == nullptr) require_count(source, name, describe_accessor(source.document, accessor).count);
    std::vector<std::uint32_t> joints =
        compressed != nullptr ? compressed->integers : read_integers(source.document, accessor);
    if (compressed != nullptr && compressed->components != 4)
        source.object.fail(fmt::format("has a compressed {} that is not VEC4", name));
    require_count(source, name, joints.size() / 4);
    return joints;
}

/// Joints and weights, interleaved for each vertex, weights scaled to a sum of 1.
void read_influences(Source& source, Primitive& primitive) {
    int sets = 0;
    while (source.attributes.has(fmt::format("JOINTS_{}", sets).c_str()) &&
           source.attributes.has(fmt::format("WEIGHTS_{}", sets).c_str())) {
        ++sets;
    }
    if (source.attributes.has(fmt::format("JOINTS_{}", sets).c_str()) ||
        source.attributes.has(fmt::format("WEIGHTS_{}", sets).c_str())) {
        source.document.warn(fmt::format("{} has JOINTS_{} or WEIGHTS_{} without the other; it is ignored",
                                         source.object.where(), sets, sets));
    }
    if (sets > 2) {
        source.document.warn(source.object.where() + " has more than 8 joints for each vertex; the first 8 are used");
        sets = 2;
    }
    if (sets == 0) return;
    const std::size_t width = static_cast<std::size_t>(4 * sets);
    primitive.influences = static_cast<int>(width);
    primitive.joints.resize(source.vertex_count * width);
    primitive.weights.resize(source.vertex_count * width);
    bool negative = false;
    for (int set = 0; set < sets; ++set) {
        const auto joints = joint_numbers(source, fmt::format("JOINTS_{}", set).c_str());
        const auto weights = attribute_floats(source, fmt::format("WEIGHTS_{}", set).c_str(), {"VEC4"});
        if (!all_finite(weights)) source.object.fail(fmt::format("has a WEIGHTS_{} that is not finite", set));
        for (std::size_t i = 0; i < joints.size(); ++i) {
            const std::size_t to = i / 4 * width + static_cast<std::size_t>(set) * 4 + i % 4;
            if (joints[i] > 0xFFFF)
                source.object.fail(fmt::format("has a JOINTS_{} that names joint {}", set, joints[i]));
            primitive.weights[to] = std::max(weights[i], 0.0f);
            // A joint that weighs nothing may be any number.
            primitive.joints[to] =
                primitive.weights[to] > 0.0f ? static_cast<std::uint16_t>(joints[i]) : std::uint16_t{0};
            negative = negative || weights[i] < 0.0f;
        }
    }
    if (negative) source.document.warn(source.object.where() + " has negative weights; zero is used instead");
    bool unnormalised = false;
    for (std::size_t vertex = 0; vertex < source.vertex_count; ++vertex) {
        float* weights = &primitive.weights[vertex * width];
        double sum = 0.0;
        for (std::size_t k = 0; k < width; ++k) sum += weights[k];
        if (!(std::abs(sum - 1.0) < 0.02)) unnormalised = true;
        if (sum <= 0.0) {
            weights[0] = 1.0f;
            continue;
        }
        for (std::size_t k = 0; k < width; ++k) weights[k] = static_cast<float>(weights[k] / sum);
    }
    if (unnormalised)
        source.document.warn(source.object.where() + " has weights whose sum is not 1; they are scaled to it");
}

std::vector<glm::vec3> target_vectors(const Source& source, const Object& target, const char* name) {
    if (!target.has(name)) return {};
    const Index accessor = target.index(name, "accessors");
    require_type(source.document, accessor, {"VEC3"}, fmt::format("{}, {},", target.where(), name));
    const std::size_t count = describe_accessor(source.document, accessor).count;
    if (count != source.vertex_count)
        target.fail(fmt::format("has {} {} for {} vertices", count, name, source.vertex_count));
    const std::vector<float> values = read_floats(source.document, accessor);
    if (!all_finite(values)) target.fail(fmt::format("has a {} that is not finite", name));
    return as_vectors<3>(values);
}

void read_targets(Source& source, Primitive& primitive) {
    for (const Object& object : source.object.children("targets", "target")) {
        MorphTarget target;
        target.positions = target_vectors(source, object, "POSITION");
        target.normals = target_vectors(source, object, "NORMAL");
        target.tangents = target_vectors(source, object, "TANGENT");
        primitive.targets.push_back(std::move(target));
    }
}

/// Strips and fans as separate triangles, all counter-clockwise (glTF 2.0, 3.7.2.1).
std::vector<std::uint32_t> triangulate(const std::vector<std::uint32_t>& order, int mode) {
    if (mode == kTriangles) return order;
    std::vector<std::uint32_t> triangles;
    for (std::size_t i = 0; i + 2 < order.size(); ++i) {
        if (mode == kTriangleStrip) {
            triangles.insert(triangles.end(), {order[i], order[i + 1 + i % 2], order[i + 2 - i % 2]});
        } else {
            triangles.insert(triangles.end(), {order[i + 1], order[i + 2], order[0]});
        }
    }
    return triangles;
}

void read_indices(Source& source, Primitive& primitive, int mode) {
    std::vector<std::uint32_t> order;
    if (source.draco != nullptr) {
        primitive.indices = source.draco->indices;
        return;
    }
    if (source.object.has("indices")) {
        const Index accessor = source.object.index("indices", "accessors");
        require_type(source.document, accessor, {"SCALAR"}, source.object.where() + ", indices,");
        order = read_integers(source.document, accessor);
        for (const std::uint32_t index : order) {
            if (index >= source.vertex_count) {
                source.object.fail(fmt::format("has an index {}, but {} vertices", index, source.vertex_count));
            }
        }
    } else {
        order.resize(source.vertex_count);
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
    }
    if (mode < kTriangles) return;
    if (mode == kTriangles && order.size() % 3 != 0) {
        source.document.warn(fmt::format("{} has {} indices, which are not whole triangles; the rest is ignored",
                                         source.object.where(), order.size()));
        order.resize(order.size() / 3 * 3);
    }
    primitive.indices = triangulate(order, mode);
}

/// False: nothing of it can be shown.
bool read_primitive(Document& document, const Object& object, Primitive& primitive) {
    const std::int64_t mode = object.integer("mode", kTriangles);
    if (mode < kPoints || mode > kTriangleFan) object.fail(fmt::format("has an unknown mode {}", mode));
    primitive.material = object.index("material", "materials");
    const Object attributes = object.child("attributes");
    for (const auto& [name, value] : attributes.json().items()) attributes.index(name.c_str(), "accessors");
    object.index("indices", "accessors");
    if (!attributes.has("POSITION")) {
        document.warn(object.where() + " has no POSITION and is not shown");
        return false;
    }
    DracoMesh draco;
    const bool compressed = object.has_extension("KHR_draco_mesh_compression");
    if (compressed) draco = decode_draco(document, object);

    Source source{document, object, attributes, compressed ? &draco : nullptr};
    read_positions(source, primitive);
    read_indices(source, primitive, static_cast<int>(mode));
    read_normals(source, primitive);
    read_tangents(source, primitive);
    read_texcoords(source, primitive);
    read_colors(source, primitive);
    read_influences(source, primitive);
    read_targets(source, primitive);
    if (mode < kTriangles) {
        document.warn(object.where() + " holds points or lines, which are not shown");
        return false;
    }
    drop_unused_vertices(primitive);
    if (primitive.normals.empty()) make_flat(primitive);
    return true;
}

}  // namespace

void read_meshes(Document& document, Scene& scene) {
    for (std::size_t i = 0; i < document.count("meshes"); ++i) {
        const Object object = document.item("meshes", "mesh", i);
        Mesh mesh;
        mesh.name = object.text("name");
        const auto primitives = object.children("primitives", "primitive");
        if (primitives.empty()) object.fail("has no primitives");
        std::size_t targets = 0;
        int largest_joint = kNone;
        for (const Object& part : primitives) {
            Primitive primitive;
            const bool shown = read_primitive(document, part, primitive);
            for (const std::uint16_t joint : primitive.joints) largest_joint = std::max<int>(largest_joint, joint);
            if (shown) mesh.primitives.push_back(std::move(primitive));
        }
        for (const Primitive& primitive : mesh.primitives) targets = std::max(targets, primitive.targets.size());
        for (Primitive& primitive : mesh.primitives) {
            if (primitive.targets.size() != targets) {
                document.warn(object.where() +
                              " has primitives with different numbers of morph targets; the missing ones do nothing");
            }
            primitive.targets.resize(targets);
        }
        for (const double weight : object.numbers("weights", 0)) mesh.weights.push_back(static_cast<float>(weight));
        if (!mesh.weights.empty() && mesh.weights.size() != targets) {
            document.warn(
                fmt::format("{} has {} weights for {} morph targets", object.where(), mesh.weights.size(), targets));
        }
        mesh.weights.resize(targets, 0.0f);
        document.largest_joints.push_back(largest_joint);
        scene.meshes.push_back(std::move(mesh));
    }
}

}  // namespace pentaprism::gltf
