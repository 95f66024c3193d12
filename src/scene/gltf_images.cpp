// Images (glTF 2.0, 3.8.4). One that is missing or broken costs a warning, and the materials that use it show their
// factors alone.

#include <fmt/format.h>

#include "base/parallel.h"
#include "scene/gltf_parts.h"
#include "scene/image_decode.h"

namespace pentaprism::gltf {

void read_images(Document& document, Scene& scene) {
    const std::size_t count = document.count("images");
    scene.images.resize(count);
    std::vector<std::string> problems(count), places(count);
    std::vector<UriBytes> files(count);
    std::vector<std::span<const std::uint8_t>> encoded(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Object object = document.item("images", "image", i);
        scene.images[i].name = object.text("name");
        places[i] = object.where();
        const Index view = object.index("bufferView", "bufferViews");
        if (view != kNone && object.has("uri")) object.fail("has both a uri and a bufferView");
        if (view != kNone) {
            encoded[i] = document.views[static_cast<std::size_t>(view)].bytes;
            if (encoded[i].empty()) problems[i] = "is in a buffer without data";
        } else if (object.has("uri")) {
            const std::string uri = object.text("uri");
            if (!uri.starts_with("data:")) places[i] += " (" + uri + ")";
            files[i] = read_uri(document, uri);
            problems[i] = files[i].problem;
            encoded[i] = files[i].bytes;
        } else {
            problems[i] = "has neither a uri nor a bufferView";
        }
    }
    parallel_for(count, [&](std::size_t i) {
        if (problems[i].empty()) decode_image(encoded[i], scene.images[i], problems[i]);
    });
    for (std::size_t i = 0; i < count; ++i) {
        if (!problems[i].empty())
            document.warn(fmt::format("{}: {}; materials are shown without it", places[i], problems[i]));
    }
}

}  // namespace pentaprism::gltf
