#pragma once
// What the barbarian of the scene `conan` wears and holds. All but the sword follow the bones of conan_body.h.

#include <glm/mat4x4.hpp>
#include <pentaprism/scene.h>
#include <vector>

#include "scene/builtin/implicit.h"

namespace pentaprism::builtin::barbarian {

/// Long hair that the wind takes to the left, a beard, brows.
Primitive hair(const ImplicitBody& head, Index material, double cell);

/// Boots, bracers, belt, straps, the plate on the left shoulder, eyes and a headband: hard parts, each on one bone.
Primitive gear(const ImplicitBody& body, Index material);

/// How many hairs each fur has.
struct FurBudget {
    int mantle, skirt, boot;
};
Primitive furs(const ImplicitBody& body, Index material, const FurBudget& budget);

/// The loincloth's front and the cape: cloth over a chain of bones.
Primitive cloth(const ImplicitBody& body, Index material);

/// The sword along +y, its grip around the origin.
std::vector<Primitive> sword(Index steel, Index fittings);

/// A frame at `origin` with its y axis along `y`, its z axis as close to `z_hint` as that allows.
glm::dmat4 frame_at(glm::dvec3 origin, glm::dvec3 y, glm::dvec3 z_hint);

}  // namespace pentaprism::builtin::barbarian
