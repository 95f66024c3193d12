// Wavefront OBJ (https://paulbourke.net/dataformats/obj/): tinyobjloader reads the lines; faces are checked, cut into
// triangles and joined into meshes here.

#include "scene/obj_reader.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <glm/geometric.hpp>
#include <map>
#include <new>
#include <pentaprism/error.h>
#include <sstream>
#include <stdexcept>
#include <tiny_obj_loader.h>

#include "scene/mtl_reader.h"
#include "scene/polygon.h"

namespace pentaprism {

namespace {

namespace fs = std::filesystem;

/// A corner of a face: indices from 0, or -1 where it has none.
struct Corner {
    int position = -1, texcoord = -1, normal = -1;
    auto operator<=>(const Corner&) const = default;
};

struct Polygon {
    std::size_t first = 0, count = 0;  ///< in File::corners
    std::size_t object = 0;            ///< in File::objects
    Index material = kNone;
};

/// The file's statements, before anything is made of them.
struct File {
    explicit File(Scene& for_scene) : scene(for_scene) {}

    Scene& scene;
    MaterialNames materials;
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> texcoords;
    std::vector<Corner> corners;
    std::vector<Polygon> polygons;
    std::vector<std::string> objects{""};
    Index material = kNone;
    std::size_t degenerate = 0;
    std::vector<std::string> unknown_materials;
};

[[noreturn]] void fail(const Scene& scene, const std::string& what) {
    throw Error(ErrorKind::kScene, scene.name + ": " + what);
}

std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// Negative numbers count back from what has been defined so far; 0 means "not given" for all but positions.
int resolve(const File& file, int index, std::size_t defined, const char* what) {
    if (index > 0) return index - 1;
    if (index == 0) return -1;
    if (static_cast<std::size_t>(-static_cast<std::int64_t>(index)) > defined) {
        fail(file.scene, fmt::format("face {} refers to {} {}, but only {} come before it", file.polygons.size(), what,
                                     index, defined));
    }
    return static_cast<int>(defined) + index;
}

void on_face(void* data, tinyobj::index_t* indices, int count) {
    File& file = *static_cast<File*>(data);
    if (count < 3) {
        ++file.degenerate;
        return;
    }
    file.polygons.push_back(
        {file.corners.size(), static_cast<std::size_t>(count), file.objects.size() - 1, file.material});
    for (int i = 0; i < count; ++i) {
        file.corners.push_back({resolve(file, indices[i].vertex_index, file.positions.size(), "vertex"),
                                resolve(file, indices[i].texcoord_index, file.texcoords.size(), "texture coordinate"),
                                resolve(file, indices[i].normal_index, file.normals.size(), "normal")});
    }
}

void on_material(void* data, const char* name, int) {
    File& file = *static_cast<File*>(data);
    const auto found = file.materials.find(trimmed(name));
    file.material = found == file.materials.end() ? kNone : found->second;
    if (file.material == kNone) file.unknown_materials.push_back(trimmed(name));
}

void on_object(void* data, const char* name) {
    static_cast<File*>(data)->objects.push_back(trimmed(name));
}

void on_group(void* data, const char** names, int count) {
    std::string joined;
    for (int i = 0; i < count; ++i) {
        if (i > 0) joined += ' ';
        joined += names[i];
    }
    static_cast<File*>(data)->objects.push_back(joined);
}

tinyobj::callback_t callbacks() {
    tinyobj::callback_t callback;
    callback.vertex_cb = [](void* data, float x, float y, float z, float) {
        static_cast<File*>(data)->positions.emplace_back(x, y, z);
    };
    callback.normal_cb = [](void* data, float x, float y, float z) {
        static_cast<File*>(data)->normals.emplace_back(x, y, z);
    };
    // v counts upwards in OBJ, downwards in a Scene.
    callback.texcoord_cb = [](void* data, float u, float v, float) {
        static_cast<File*>(data)->texcoords.emplace_back(u, 1.0f - v);
    };
    callback.index_cb = on_face;
    callback.usemtl_cb = on_material;
    callback.object_cb = on_object;
    callback.group_cb = on_group;
    return callback;
}

/// Libraries are read first: their materials are known when a face asks for one.
void read_libraries(const std::string& text, const fs::path& folder, File& file) {
    std::istringstream lines(text);
    std::vector<fs::path> seen;
    for (std::string line; std::getline(lines, line);)
        for (const fs::path& library : mtl_files(line, folder)) {
            if (std::find(seen.begin(), seen.end(), library) != seen.end()) continue;
            seen.push_back(library);
            read_mtl(library, file.scene, file.materials);
        }
}

/// Many files number texture coordinates or normals that they do not hold at all: then there are none.
void drop_absent_attributes(File& file) {
    const bool texcoords = file.texcoords.empty(), normals = file.normals.empty();
    bool dropped = false;
    for (Corner& corner : file.corners) {
        dropped = dropped || (texcoords && corner.texcoord >= 0) || (normals && corner.normal >= 0);
        if (texcoords) corner.texcoord = -1;
        if (normals) corner.normal = -1;
    }
    if (dropped)
        file.scene.warnings.push_back(file.scene.name +
                                      ": faces refer to texture coordinates or normals, but there are none");
}

void check_indices(const File& file) {
    const auto check = [&](std::size_t face, int index, std::size_t count, const char* what) {
        if (index >= 0 && static_cast<std::size_t>(index) >= count) {
            fail(file.scene, fmt::format("face {} refers to {} {} of {}", face + 1, what, index + 1, count));
        }
    };
    for (std::size_t face = 0; face < file.polygons.size(); ++face) {
        const Polygon& polygon = file.polygons[face];
        for (std::size_t i = polygon.first; i < polygon.first + polygon.count; ++i) {
            const Corner& corner = file.corners[i];
            if (corner.position < 0)
                fail(file.scene, fmt::format("face {} refers to vertex 0; the first is 1", face + 1));
            check(face, corner.position, file.positions.size(), "vertex");
            check(face, corner.texcoord, file.texcoords.size(), "texture coordinate");
            check(face, corner.normal, file.normals.size(), "normal");
        }
    }
    for (std::size_t i = 0; i < file.positions.size(); ++i) {
        if (!std::isfinite(file.positions[i].x + file.positions[i].y + file.positions[i].z)) {
            fail(file.scene, fmt::format("vertex {} is not finite", i + 1));
        }
    }
}

/// The surface's normal at each position, over all faces around it.
std::vector<glm::vec3> normals_of_positions(const File& file,
                                            const std::vector<std::array<std::size_t, 3>>& triangles) {
    std::vector<glm::dvec3> sums(file.positions.size(), glm::dvec3(0.0));
    for (const auto& triangle : triangles) {
        std::array<std::size_t, 3> p;
        for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<std::size_t>(file.corners[triangle[k]].position);
        const glm::dvec3 a(file.positions[p[0]]), b(file.positions[p[1]]), c(file.positions[p[2]]);
        const glm::dvec3 area = glm::cross(b - a, c - a);
        for (const std::size_t i : p) sums[i] += area;
    }
    std::vector<glm::vec3> normals(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const double length = glm::length(sums[i]);
        normals[i] = length > 0.0 ? glm::vec3(sums[i] / length) : glm::vec3(0.0f, 0.0f, 1.0f);
    }
    return normals;
}

/// Makes a Scene's meshes: one for each object, one primitive for each of its materials, one vertex for each
/// combination of indices.
class MeshBuilder {
  public:
    MeshBuilder(const File& file, std::vector<glm::vec3> smooth) : file_(file), smooth_(std::move(smooth)) {}

    void add(const Polygon& polygon, const std::array<std::size_t, 3>& triangle, bool textured) {
        Part& part = part_of(polygon, textured);
        for (const std::size_t corner : triangle)
            part.primitive.indices.push_back(vertex(part, file_.corners[corner], textured));
    }

    void finish(Scene& scene) {
        for (auto& [object, parts] : objects_) {
            Mesh mesh;
            mesh.name = file_.objects[object];
            for (const std::size_t part : parts) mesh.primitives.push_back(std::move(parts_[part].primitive));
            Node node;
            node.name = mesh.name;
            node.mesh = static_cast<Index>(scene.meshes.size());
            scene.roots.push_back(static_cast<Index>(scene.nodes.size()));
            scene.meshes.push_back(std::move(mesh));
            scene.nodes.push_back(std::move(node));
        }
    }

  private:
    struct Part {
        Primitive primitive;
        std::map<Corner, std::uint32_t> vertices;
    };

    Part& part_of(const Polygon& polygon, bool textured) {
        const auto [found, added] = keys_.try_emplace({polygon.object, polygon.material, textured}, parts_.size());
        if (added) {
            parts_.emplace_back().primitive.material = polygon.material;
            objects_[polygon.object].push_back(found->second);
        }
        return parts_[found->second];
    }

    std::uint32_t vertex(Part& part, const Corner& corner, bool textured) {
        Primitive& primitive = part.primitive;
        const auto [found, added] =
            part.vertices.try_emplace(corner, static_cast<std::uint32_t>(primitive.positions.size()));
        if (!added) return found->second;
        const auto position = static_cast<std::size_t>(corner.position);
        primitive.positions.push_back(file_.positions[position]);
        glm::vec3 normal = smooth_[position];
        if (corner.normal >= 0) {
            const glm::vec3 given = file_.normals[static_cast<std::size_t>(corner.normal)];
            const float length = glm::length(given);
            if (std::isfinite(length) && length > 0.0f) normal = given / length;
        }
        primitive.normals.push_back(normal);
        if (textured) {
            const glm::vec2 uv = file_.texcoords[static_cast<std::size_t>(corner.texcoord)];
            primitive.texcoords[0].push_back(std::isfinite(uv.x + uv.y) ? uv : glm::vec2(0.0f));
        }
        return found->second;
    }

    const File& file_;
    std::vector<glm::vec3> smooth_;
    std::vector<Part> parts_;
    std::map<std::tuple<std::size_t, Index, bool>, std::size_t> keys_;
    std::map<std::size_t, std::vector<std::size_t>> objects_;
};

void build_meshes(const File& file, Scene& scene) {
    std::vector<std::array<std::size_t, 3>> triangles;
    std::vector<std::size_t> polygons;  // of each triangle
    std::vector<glm::vec3> corners;
    for (std::size_t i = 0; i < file.polygons.size(); ++i) {
        const Polygon& polygon = file.polygons[i];
        corners.clear();
        for (std::size_t k = 0; k < polygon.count; ++k) {
            corners.push_back(file.positions[static_cast<std::size_t>(file.corners[polygon.first + k].position)]);
        }
        for (const auto& [a, b, c] : triangulate_polygon(corners)) {
            triangles.push_back({polygon.first + a, polygon.first + b, polygon.first + c});
            polygons.push_back(i);
        }
    }
    MeshBuilder builder(file, normals_of_positions(file, triangles));
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Polygon& polygon = file.polygons[polygons[i]];
        bool textured = true;
        for (std::size_t k = 0; k < polygon.count; ++k)
            textured = textured && file.corners[polygon.first + k].texcoord >= 0;
        builder.add(polygon, triangles[i], textured);
    }
    builder.finish(scene);
}

void warn_of_leftovers(const File& file, Scene& scene) {
    if (file.degenerate > 0)
        scene.warnings.push_back(
            fmt::format("{}: {} faces have fewer than 3 vertices and are not shown", scene.name, file.degenerate));
    if (file.polygons.empty()) scene.warnings.push_back(scene.name + ": has no faces, nothing is shown");
    std::vector<std::string> names = file.unknown_materials;
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    for (const std::string& name : names) {
        scene.warnings.push_back(
            fmt::format("{}: material \"{}\" is in no library; its faces are shown in white", scene.name, name));
    }
}

std::string read_text(const fs::path& path) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) throw Error(ErrorKind::kScene, path.string() + ": is a folder");
    errno = 0;
    std::ifstream stream(path, std::ios::binary);
    if (!stream)
        throw Error(ErrorKind::kScene, path.string() + ": " + (errno != 0 ? std::strerror(errno) : "cannot be opened"));
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

Scene read_scene(const fs::path& path) {
    Scene scene;
    scene.name = path.filename().string();
    const std::string text = read_text(path);
    File file(scene);
    read_libraries(text, path.parent_path(), file);
    std::istringstream stream(text);
    tinyobj::LoadObjWithCallback(stream, callbacks(), &file);
    drop_absent_attributes(file);
    check_indices(file);
    build_meshes(file, scene);
    warn_of_leftovers(file, scene);
    return scene;
}

}  // namespace

Scene load_obj(const fs::path& path) {
    try {
        return read_scene(path);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::kScene, path.filename().string() + ": needs more memory than there is");
    } catch (const std::length_error&) {
        throw Error(ErrorKind::kScene, path.filename().string() + ": needs more memory than there is");
    }
}

}  // namespace pentaprism
