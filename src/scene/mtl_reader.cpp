#include "scene/mtl_reader.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <sstream>
#include <tiny_obj_loader.h>

#include "scene/image_decode.h"

namespace pentaprism {

namespace {

namespace fs = std::filesystem;

/// The textures of one library; each file is read once.
class TextureFiles {
  public:
    TextureFiles(fs::path folder, Scene& scene) : folder_(std::move(folder)), scene_(scene) {}

    /// kNone, with a warning, when the file cannot be used.
    Index image(std::string name) {
        std::replace(name.begin(), name.end(), '\\', '/');
        if (const auto known = images_.find(name); known != images_.end()) return known->second;
        return images_[name] = read(name);
    }

  private:
    Index read(const std::string& name) {
        // As given, else beside the library: paths of the author's own machine are common.
        fs::path file = folder_ / name;
        std::error_code ignored;
        if (!fs::is_regular_file(file, ignored)) file = folder_ / fs::path(name).filename();
        std::ifstream stream;
        if (fs::is_regular_file(file, ignored)) stream.open(file, std::ios::binary);
        if (!stream.is_open()) {
            warn(name, "cannot be opened");
            return kNone;
        }
        const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
        Image image;
        image.name = name;
        std::string problem;
        if (!decode_image({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, image, problem)) {
            warn(name, problem);
            return kNone;
        }
        scene_.images.push_back(std::move(image));
        return static_cast<Index>(scene_.images.size()) - 1;
    }

    void warn(const std::string& name, const std::string& problem) {
        scene_.warnings.push_back(
            fmt::format("{}: texture \"{}\" {}; materials are shown without it", scene_.name, name, problem));
    }

    fs::path folder_;
    Scene& scene_;
    std::map<std::string, Index> images_;
};

/// MTL counts v upwards: uv * s + o there is (u * s + o, v * s + 1 - s - o) here.
TextureRef texture_ref(Index image, const tinyobj::texture_option_t& options) {
    TextureRef texture;
    texture.image = image;
    texture.scale = {options.scale[0], options.scale[1]};
    texture.offset = {options.origin_offset[0], 1.0f - options.scale[1] - options.origin_offset[1]};
    if (options.clamp) texture.wrap_s = texture.wrap_t = Wrap::kClampToEdge;
    return texture;
}

bool has_holes(const Image& image) {
    for (std::size_t i = 3; i < image.texels.size(); i += 4) {
        if (image.texels[i] < 128) return true;
    }
    return false;
}

/// The colours of one image with the opacity of another: its alpha if that says anything, else its brightness.
Image with_opacity(const Image& color, const Image& opacity) {
    Image result = color;
    result.name += " with " + opacity.name;
    const bool alpha = has_holes(opacity);
    for (std::size_t i = 0; i < result.texels.size(); i += 4)
        result.texels[i + 3] = opacity.texels[i + (alpha ? 3 : 0)];
    return result;
}

void read_opacity(const tinyobj::material_t& source, TextureFiles& files, Scene& scene, Material& material) {
    material.base_color.w = std::clamp(source.dissolve, 0.0f, 1.0f);
    if (material.base_color.w < 1.0f) material.alpha_mode = AlphaMode::kBlend;
    Index& image = material.base_color_texture.image;
    if (!source.alpha_texname.empty()) {
        const Index opacity = files.image(source.alpha_texname);
        const auto at = [&](Index i) -> const Image& { return scene.images[static_cast<std::size_t>(i)]; };
        if (opacity == kNone) return;
        if (image == kNone || at(image).width != at(opacity).width || at(image).height != at(opacity).height) {
            scene.warnings.push_back(
                fmt::format("{}: material \"{}\": map_d works only with a map_Kd of the same size; it is left out",
                            scene.name, source.name));
            return;
        }
        if (opacity != image) {
            Image both = with_opacity(at(image), at(opacity));
            scene.images.push_back(std::move(both));
            image = static_cast<Index>(scene.images.size()) - 1;
        }
    }
    if (image != kNone && material.alpha_mode == AlphaMode::kOpaque &&
        has_holes(scene.images[static_cast<std::size_t>(image)])) {
        material.alpha_mode = AlphaMode::kMask;
    }
}

/// Pr and Pm where the library has them, else the width of Blinn-Phong highlights: alpha = roughness^2 = sqrt(2 / (Ns +
/// 2)) (Walter et al. 2007, section 5.2).
void read_roughness(const tinyobj::material_t& source, Material& material) {
    material.metallic = std::clamp(source.metallic, 0.0f, 1.0f);
    const float shininess = std::clamp(source.shininess, 0.0f, 10000.0f);
    material.roughness = source.roughness > 0.0f || source.metallic > 0.0f ? std::clamp(source.roughness, 0.0f, 1.0f)
                                                                           : std::pow(2.0f / (shininess + 2.0f), 0.25f);
}

Material read_material(const tinyobj::material_t& source, TextureFiles& files, Scene& scene) {
    Material material;
    material.name = source.name;
    const auto finite = [](float value) { return std::isfinite(value) ? std::clamp(value, 0.0f, 1e9f) : 0.0f; };
    for (int k = 0; k < 3; ++k) {
        material.base_color[k] = std::min(finite(source.diffuse[k]), 1.0f);
        material.emissive[k] = finite(source.emission[k]);
    }
    if (!source.diffuse_texname.empty())
        material.base_color_texture = texture_ref(files.image(source.diffuse_texname), source.diffuse_texopt);
    if (!source.emissive_texname.empty()) {
        material.emissive_texture = texture_ref(files.image(source.emissive_texname), source.emissive_texopt);
        if (material.emissive == glm::vec3(0.0f) && material.emissive_texture.image != kNone)
            material.emissive = glm::vec3(1.0f);
    }
    if (!source.normal_texname.empty())
        material.normal_texture = texture_ref(files.image(source.normal_texname), source.normal_texopt);
    read_opacity(source, files, scene, material);
    read_roughness(source, material);
    // OBJ says nothing of sides, and its leaves and cloths are single sheets.
    material.double_sided = true;
    return material;
}

}  // namespace

std::vector<fs::path> mtl_files(const std::string& line, const fs::path& folder) {
    constexpr const char* kSpace = " \t\r";
    std::istringstream words(line);
    std::string word;
    if (!(words >> word) || word != "mtllib" || !(words >> std::ws)) return {};
    std::string names;
    std::getline(words, names);
    names.erase(names.find_last_not_of(kSpace) + 1);
    std::error_code ignored;
    if (fs::is_regular_file(folder / names, ignored) || names.find_first_of(kSpace) == std::string::npos)
        return {folder / names};
    std::vector<fs::path> files;
    for (words = std::istringstream(names); words >> word;) files.push_back(folder / word);
    return files;
}

void read_mtl(const fs::path& file, Scene& scene, MaterialNames& names) {
    std::error_code ignored;
    std::ifstream stream;
    if (fs::is_regular_file(file, ignored)) stream.open(file, std::ios::binary);
    if (!stream.is_open()) {
        scene.warnings.push_back(
            fmt::format("{}: the material library \"{}\" cannot be opened; its materials are shown in white",
                        scene.name, file.filename().string()));
        return;
    }
    std::map<std::string, int> found;
    std::vector<tinyobj::material_t> materials;
    std::string warnings, errors;
    tinyobj::LoadMtl(&found, &materials, &stream, &warnings, &errors);
    TextureFiles files(file.parent_path(), scene);
    for (const auto& [name, number] : found) {
        scene.materials.push_back(read_material(materials[static_cast<std::size_t>(number)], files, scene));
        names[name] = static_cast<Index>(scene.materials.size()) - 1;
    }
}

}  // namespace pentaprism
