// Nodes, skins and scenes (glTF 2.0, 3.5 and 3.7.3) with EXT_mesh_gpu_instancing.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "scene/gltf_lens.h"
#include "scene/gltf_parts.h"

namespace pentaprism::gltf {

namespace {

/// x y z w in the file.
glm::dquat unit_rotation(Document& document, const std::string& where, double x, double y, double z, double w) {
    const double length = std::sqrt(x * x + y * y + z * z + w * w);
    if (!(std::abs(length - 1.0) < 0.01))
        document.warn(where + " has a rotation that is not a unit quaternion; it is scaled to one");
    if (!(length > 0.0)) return {1.0, 0.0, 0.0, 0.0};
    return {w / length, x / length, y / length, z / length};
}

void read_transform(Document& document, const Object& object, Node& node) {
    if (const auto m = object.numbers("matrix", 16); !m.empty()) {
        if (object.has("translation") || object.has("rotation") || object.has("scale")) {
            document.warn(object.where() + " has a matrix beside translation, rotation or scale; the matrix is used");
        }
        glm::dmat4 matrix;
        for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = m[static_cast<std::size_t>(i)];
        if (m[3] != 0.0 || m[7] != 0.0 || m[11] != 0.0 || m[15] != 1.0) {
            document.warn(object.where() + " has a matrix whose last row is not 0 0 0 1; it is taken as such");
            matrix[0][3] = matrix[1][3] = matrix[2][3] = 0.0;
            matrix[3][3] = 1.0;
        }
        if (matrix != glm::dmat4(1.0)) node.matrix = matrix;
        return;
    }
    if (const auto t = object.numbers("translation", 3); !t.empty()) node.transform.translation = {t[0], t[1], t[2]};
    if (const auto r = object.numbers("rotation", 4); !r.empty()) {
        node.transform.rotation = unit_rotation(document, object.where(), r[0], r[1], r[2], r[3]);
    }
    if (const auto s = object.numbers("scale", 3); !s.empty()) node.transform.scale = {s[0], s[1], s[2]};
}

/// Values of an instance attribute, and a check of its length against the others.
std::vector<float> instance_values(Document& document, const Object& attributes, const char* name, const char* type,
                                   std::size_t& count) {
    if (!attributes.has(name)) return {};
    const Index accessor = attributes.index(name, "accessors");
    require_type(document, accessor, {type}, fmt::format("{} {},", attributes.where(), name));
    const std::size_t entries = describe_accessor(document, accessor).count;
    if (count != 0 && entries != count)
        attributes.fail(fmt::format("have {} {} for {} instances", entries, name, count));
    count = entries;
    std::vector<float> values = read_floats(document, accessor);
    if (!all_finite(values)) attributes.fail(fmt::format("have a {} that is not finite", name));
    return values;
}

void read_instances(Document& document, const Object& object, Node& node) {
    if (!object.has_extension("EXT_mesh_gpu_instancing")) return;
    const Object attributes = object.extension("EXT_mesh_gpu_instancing").child("attributes");
    std::size_t count = 0;
    const auto t = instance_values(document, attributes, "TRANSLATION", "VEC3", count);
    const auto r = instance_values(document, attributes, "ROTATION", "VEC4", count);
    const auto s = instance_values(document, attributes, "SCALE", "VEC3", count);
    if (node.mesh == kNone) {
        document.warn(object.where() + " has instances but no mesh");
        return;
    }
    node.instances.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        Transform& instance = node.instances[i];
        if (!t.empty()) instance.translation = {t[3 * i], t[3 * i + 1], t[3 * i + 2]};
        if (!r.empty())
            instance.rotation =
                unit_rotation(document, object.where(), r[4 * i], r[4 * i + 1], r[4 * i + 2], r[4 * i + 3]);
        if (!s.empty()) instance.scale = {s[3 * i], s[3 * i + 1], s[3 * i + 2]};
    }
}

/// What nodes say of the lenses of the cameras they hold. Nodes that hold the same camera share it unless they say
/// different things: then the later one gets a copy.
class NodeLenses {
  public:
    explicit NodeLenses(const Scene& scene) : held_(scene.cameras.size(), false) {
        for (const Camera& camera : scene.cameras) lenses_.push_back(camera.lens);
    }

    void read(Document& document, const Object& object, Scene& scene, Node& node) {
        const auto index = static_cast<std::size_t>(node.camera);
        LensInfo lens = lenses_[index];
        read_lens(document, object, lens);
        if (!held_[index]) {
            held_[index] = true;
            scene.cameras[index].lens = lens;
        } else if (!(lens == scene.cameras[index].lens)) {
            document.spend(scene.cameras[index].name.size());
            document.original_cameras.push_back(node.camera);
            node.camera = static_cast<Index>(scene.cameras.size());
            scene.cameras.push_back(Camera(scene.cameras[index]));
            scene.cameras.back().lens = lens;
        }
    }

  private:
    std::vector<LensInfo> lenses_;  // as the file's cameras have them
    std::vector<bool> held_;        // by a node before
};

void read_node(Document& document, Scene& scene, const Object& object, NodeLenses& lenses, Node& node) {
    node.name = object.text("name");
    node.children = object.indices("children", "nodes");
    read_transform(document, object, node);
    node.mesh = object.index("mesh", "meshes");
    node.skin = object.index("skin", "skins");
    node.camera = object.index("camera", "cameras");
    if (node.skin != kNone && node.mesh == kNone) {
        document.warn(object.where() + " has a skin but no mesh");
        node.skin = kNone;
    }
    for (const double weight : object.numbers("weights", 0)) node.weights.push_back(static_cast<float>(weight));
    if (!node.weights.empty()) {
        const std::size_t targets =
            node.mesh == kNone ? 0 : scene.meshes[static_cast<std::size_t>(node.mesh)].weights.size();
        if (node.weights.size() != targets) {
            document.warn(
                fmt::format("{} has {} weights for {} morph targets", object.where(), node.weights.size(), targets));
        }
        node.weights.resize(targets, 0.0f);
    }
    if (node.camera != kNone) lenses.read(document, object, scene, node);
    if (object.has_extension("KHR_lights_punctual")) {
        const Object light = object.extension("KHR_lights_punctual");
        const std::size_t index = light.required_size("light");
        if (index >= scene.lights.size())
            light.fail(fmt::format("refers to light {}, but there are {} lights", index, scene.lights.size()));
        node.light = static_cast<Index>(index);
    }
    read_instances(document, object, node);
    if (node.skin != kNone && !node.instances.empty()) {
        document.warn(object.where() + " is skinned and instanced; it is shown once");
        node.instances.clear();
    }
}

void link_parents(const Document& document, Scene& scene) {
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        for (const Index child : scene.nodes[i].children) {
            Node& node = scene.nodes[static_cast<std::size_t>(child)];
            if (child == static_cast<Index>(i)) document.fail(fmt::format("node {} is its own child", i));
            if (node.parent != kNone)
                document.fail(fmt::format("node {} has two parents, nodes {} and {}", child, node.parent, i));
            node.parent = static_cast<Index>(i);
        }
    }
    // With one parent at most for each node, what cannot be reached from nodes without a parent lies on a cycle or
    // below one.
    std::vector<Index> open;
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        if (scene.nodes[i].parent == kNone) open.push_back(static_cast<Index>(i));
    }
    std::vector<bool> reached(scene.nodes.size(), false);
    while (!open.empty()) {
        const auto i = static_cast<std::size_t>(open.back());
        open.pop_back();
        reached[i] = true;
        open.insert(open.end(), scene.nodes[i].children.begin(), scene.nodes[i].children.end());
    }
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        if (!reached[i]) document.fail(fmt::format("node {} is its own ancestor", i));
    }
}

void read_inverse_bind_matrices(const Document& document, const Object& object, Skin& skin) {
    skin.inverse_bind_matrices.assign(skin.joints.size(), glm::mat4(1.0f));
    const Index accessor = object.index("inverseBindMatrices", "accessors");
    if (accessor == kNone) return;
    require_type(document, accessor, {"MAT4"}, object.where() + ", inverseBindMatrices,");
    const std::size_t count = describe_accessor(document, accessor).count;
    if (count < skin.joints.size())
        object.fail(fmt::format("has {} inverse bind matrices for {} joints", count, skin.joints.size()));
    const std::vector<float> values = read_floats(document, accessor);
    if (!all_finite(values)) object.fail("has an inverse bind matrix that is not finite");
    for (std::size_t i = 0; i < skin.joints.size(); ++i) {
        for (std::size_t k = 0; k < 16; ++k)
            skin.inverse_bind_matrices[i][static_cast<int>(k / 4)][static_cast<int>(k % 4)] = values[16 * i + k];
    }
}

/// Joints that vertices name must exist in each skin that the mesh is used with.
void check_skinned_nodes(Document& document, Scene& scene) {
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        Node& node = scene.nodes[i];
        if (node.skin == kNone) continue;
        const int joint = document.largest_joints[static_cast<std::size_t>(node.mesh)];
        const std::size_t joints = scene.skins[static_cast<std::size_t>(node.skin)].joints.size();
        if (joint < 0) {
            document.warn(
                fmt::format("node {} has a skin, but mesh {} names no joints; it is shown without", i, node.mesh));
            node.skin = kNone;
        } else if (static_cast<std::size_t>(joint) >= joints) {
            document.fail(fmt::format("node {}: mesh {} names joint {}, but skin {} has {}", i, node.mesh, joint,
                                      node.skin, joints));
        }
    }
}

/// `extras` of a scene: what a built-in one has behind it.
void read_background(Document& document, const Object& object, Scene& scene) {
    const auto extras = object.json().find("extras");
    if (extras == object.json().end() || !extras->is_object() || !extras->contains("background")) return;
    const Json& color = (*extras)["background"];
    const bool usable =
        color.is_array() && color.size() == 3 && std::all_of(color.begin(), color.end(), [](const Json& value) {
            return value.is_number() && value.get<double>() >= 0.0 && value.get<double>() <= 65504.0;
        });
    if (usable)
        scene.background = glm::vec3(color[0].get<float>(), color[1].get<float>(), color[2].get<float>());
    else
        document.warn(object.where() + ", extras, has a background that is not usable; it is ignored");
}

}  // namespace

void read_nodes(Document& document, Scene& scene) {
    scene.nodes.resize(document.count("nodes"));
    NodeLenses lenses(scene);
    for (std::size_t i = 0; i < scene.nodes.size(); ++i)
        read_node(document, scene, document.item("nodes", "node", i), lenses, scene.nodes[i]);
    link_parents(document, scene);
}

void read_skins(Document& document, Scene& scene) {
    for (std::size_t i = 0; i < document.count("skins"); ++i) {
        const Object object = document.item("skins", "skin", i);
        Skin skin;
        skin.name = object.text("name");
        skin.joints = object.indices("joints", "nodes");
        if (skin.joints.empty()) object.fail("has no joints");
        object.index("skeleton", "nodes");
        read_inverse_bind_matrices(document, object, skin);
        scene.skins.push_back(std::move(skin));
    }
    check_skinned_nodes(document, scene);
}

void read_roots(Document& document, Scene& scene) {
    for (std::size_t i = 0; i < document.count("scenes"); ++i)
        document.item("scenes", "scene", i).indices("nodes", "nodes");
    const Index chosen = document.root().index("scene", "scenes");
    if (document.count("scenes") > 0) {
        const Object shown = document.item("scenes", "scene", static_cast<std::size_t>(std::max(chosen, 0)));
        scene.roots = shown.indices("nodes", "nodes");
        read_background(document, shown, scene);
    } else {
        for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
            if (scene.nodes[i].parent == kNone) scene.roots.push_back(static_cast<Index>(i));
        }
    }
    for (Node& node : scene.nodes) node.visible = false;
    std::vector<bool> hidden(scene.nodes.size(), false);
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        const Object node = document.item("nodes", "node", i);
        if (node.has_extension("KHR_node_visibility"))
            hidden[i] = !node.extension("KHR_node_visibility").boolean("visible", true);
    }
    std::vector<bool> reached(scene.nodes.size(), false);
    std::vector<Index> open = scene.roots;
    for (const Index root : scene.roots) {
        if (scene.nodes[static_cast<std::size_t>(root)].parent != kNone)
            document.fail(fmt::format("node {} is a root of the scene but has a parent", root));
    }
    while (!open.empty()) {
        const auto i = static_cast<std::size_t>(open.back());
        open.pop_back();
        if (reached[i]) document.fail(fmt::format("node {} is twice in the scene", i));
        reached[i] = true;
        Node& node = scene.nodes[i];
        // Parents come before their children, and hide them.
        hidden[i] = hidden[i] || (node.parent != kNone && hidden[static_cast<std::size_t>(node.parent)]);
        node.visible = !hidden[i];
        open.insert(open.end(), node.children.begin(), node.children.end());
    }
}

}  // namespace pentaprism::gltf
