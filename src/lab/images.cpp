#include "lab/images.h"

#include <algorithm>
#include <numeric>

#include "lab/pixels.h"

namespace pentaprism {
namespace {

Field field_of(const CoverMap& map, bool wasted, int spp) {
    Field field{map.width, map.height, std::vector<float>(map.tested.size())};
    for (std::size_t i = 0; i < map.tested.size(); ++i)
        field.values[i] =
            static_cast<float>(wasted ? map.tested[i] - map.covered[i] : map.tested[i]) / static_cast<float>(spp);
    return field;
}

double mean(const Field& field) {
    return std::accumulate(field.values.begin(), field.values.end(), 0.0) / static_cast<double>(field.values.size());
}

// A scale that a few hot pixels do not stretch.
float near_largest(const Field& field) {
    std::vector<float> values = field.values;
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

BenchImage image_of(const Pixels& pixels, const std::string& scene, const std::string& effect,
                    const std::string& method, BenchImageKind kind, double largest, double mean) {
    return {scene, effect, method, kind, pixels.width, pixels.height, largest, mean, encode_png(pixels)};
}

}  // namespace

void add_map_images(const std::vector<MethodMap>& maps, const Picture& picture, int spp, const std::string& scene,
                    const std::string& effect, std::vector<BenchImage>& images) {
    std::vector<std::pair<const MethodMap*, Field>> tested;
    float largest = 0.0f;
    for (const MethodMap& map : maps) {
        if (std::accumulate(map.cover.tested.begin(), map.cover.tested.end(), std::uint64_t{0}) == 0) continue;
        tested.emplace_back(&map, field_of(map.cover, false, spp));
        largest = std::max(largest, near_largest(tested.back().second));
    }
    for (const auto& [map, field] : tested) {
        const Field wasted = field_of(map->cover, true, spp);
        images.push_back(image_of(heat_colours(field, largest), scene, effect, map->method, BenchImageKind::kTested,
                                  largest, mean(field)));
        images.push_back(image_of(heat_colours(wasted, largest), scene, effect, map->method, BenchImageKind::kWasted,
                                  largest, mean(wasted)));
    }
    for (const MethodMap& map : maps) {
        if (std::all_of(map.lost.begin(), map.lost.end(), [](std::uint32_t n) { return n == 0; })) continue;
        Field lost{map.cover.width, map.cover.height, std::vector<float>(map.lost.begin(), map.lost.end())};
        for (float& value : lost.values) value /= static_cast<float>(spp);
        images.push_back(image_of(marked_picture(picture, lost), scene, effect, map.method, BenchImageKind::kMissing,
                                  1.0, mean(lost)));
    }
}

BenchImage picture_image(const Picture& picture, const std::string& scene, const std::string& effect) {
    return image_of(displayed(picture), scene, effect, "", BenchImageKind::kPicture, 0.0, 0.0);
}

}  // namespace pentaprism
