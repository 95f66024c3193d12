#pragma once
// One recipe for each built-in scene, in the file of its name.

#include <pentaprism/scene.h>

namespace pentaprism::builtin {

Scene fairy_forest();
Scene hand();
Scene car();
Scene dragonfly();
Scene cubes();
Scene conan();
Scene race();
Scene bridge();

}  // namespace pentaprism::builtin
