// The list of built-in scenes.

#include <fmt/format.h>
#include <pentaprism/error.h>

#include "scene/builtin/recipes.h"

namespace pentaprism {
namespace {

struct Recipe {
    BuiltinScene scene;
    Scene (*make)();
};

constexpr Recipe kRecipes[] = {
    {{"fairy-forest",
      "a fairy crosses a glade at dusk: thousands of leaves, falling petals, glowing lights out of focus", 170000},
     builtin::fairy_forest},
    {{"conan", "a barbarian swings his sword on a hill at dusk, fire and sparks on the wind behind him", 130000},
     builtin::conan},
    {{"bridge", "a bus crosses a suspension bridge, all of it a model landscape: trains, boats, an island, a city",
      1800000},
     builtin::bridge},
    {{"race", "five racing cars in a fast bend before a full grandstand, the camera running ahead of them", 130000},
     builtin::race},
    {{"dragonfly", "a dragonfly hovers over a lily pond, wings beating, reeds close to the lens", 85000},
     builtin::dragonfly},
    {{"car", "racing cars of the sixties seen from beside the track, wheels spinning, the camera panning along", 54000},
     builtin::car},
    {{"hand", "a skinned hand waves and closes before the lights of a city at night", 15000}, builtin::hand},
    {{"cubes", "textured boxes tumble over a checkered floor that passes below the camera", 50}, builtin::cubes},
};

}  // namespace

std::vector<BuiltinScene> builtin_scenes() {
    std::vector<BuiltinScene> list;
    for (const Recipe& recipe : kRecipes) list.push_back(recipe.scene);
    return list;
}

Scene make_builtin_scene(std::string_view name) {
    std::string known;
    for (const Recipe& recipe : kRecipes) {
        if (recipe.scene.name == name) return recipe.make();
        known += (known.empty() ? "" : ", ") + std::string(recipe.scene.name);
    }
    throw Error(ErrorKind::kScene,
                fmt::format("builtin:{}: there is no such built-in scene; there are {}", name, known));
}

}  // namespace pentaprism
