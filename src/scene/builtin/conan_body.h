#pragma once
// The barbarian of the scene `conan`: his bones, and his body as muscles on them. His right is -x, he looks along +z.

#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <vector>

#include "scene/builtin/implicit.h"

namespace pentaprism::builtin::barbarian {

enum Bone {
    kPelvis,
    kSpine,
    kChest,
    kNeck,
    kHead,
    kRightArm,
    kRightForearm,
    kRightHand,
    kLeftArm,
    kLeftForearm,
    kLeftHand,
    kRightThigh,
    kRightShin,
    kRightFoot,
    kLeftThigh,
    kLeftShin,
    kLeftFoot,
    kCape1,
    kCape2,
    kCape3,
    kCape4,
    kTail1,
    kTail2,
    kSkirt,
    kBones
};

struct Joint {
    const char* name;
    int parent;
    glm::dvec3 place;
};
inline const std::array<Joint, kBones> kJoints{{
    {"pelvis", -1, {0.0, 0.95, 0.0}},
    {"spine", kPelvis, {0.0, 1.10, 0.0}},
    {"chest", kSpine, {0.0, 1.28, -0.01}},
    {"neck", kChest, {0.0, 1.53, -0.02}},
    {"head", kNeck, {0.0, 1.64, 0.0}},
    {"right arm", kChest, {-0.25, 1.47, -0.03}},
    {"right forearm", kRightArm, {-0.52, 1.57, 0.06}},
    {"right hand", kRightForearm, {-0.72, 1.74, 0.18}},
    {"left arm", kChest, {0.25, 1.46, -0.03}},
    {"left forearm", kLeftArm, {0.46, 1.24, -0.06}},
    {"left hand", kLeftForearm, {0.58, 1.10, 0.16}},
    {"right thigh", kPelvis, {-0.12, 0.93, -0.02}},
    {"right shin", kRightThigh, {-0.30, 0.54, 0.02}},
    {"right foot", kRightShin, {-0.40, 0.10, -0.16}},
    {"left thigh", kPelvis, {0.12, 0.93, 0.02}},
    {"left shin", kLeftThigh, {0.27, 0.56, 0.23}},
    {"left foot", kLeftShin, {0.33, 0.10, 0.16}},
    {"cape 1", kChest, {0.02, 1.50, -0.13}},
    {"cape 2", kCape1, {0.22, 1.24, -0.30}},
    {"cape 3", kCape2, {0.48, 1.02, -0.42}},
    {"cape 4", kCape3, {0.76, 0.86, -0.50}},
    {"hair 1", kHead, {0.03, 1.72, -0.09}},
    {"hair 2", kTail1, {0.16, 1.66, -0.16}},
    {"skirt", kPelvis, {0.0, 0.93, 0.08}},
}};

/// Where a bone begins in the rest pose, which is the middle of the stroke.
inline glm::dvec3 at(int bone) {
    return kJoints[std::size_t(bone)].place;
}

inline const glm::dvec3 kGrip{-0.765, 1.785, 0.215};                                 ///< middle of the sword's hilt
inline const glm::dvec3 kBladeAxis = glm::normalize(glm::dvec3(-0.90, 0.30, 0.22));  ///< from grip to point

class Anatomy {
  public:
    std::vector<Limb> limbs;
    int group = 0, bone = 0;
    glm::dvec3 color{0.0};

    void add(glm::dvec3 a, glm::dvec3 b, double ra, double rb) { limbs.push_back({a, b, ra, rb, color, group, bone}); }

    /// A belly between thin ends.
    void muscle(glm::dvec3 a, glm::dvec3 b, double thick, double belly = 0.45, double ends = 0.55) {
        const glm::dvec3 middle = glm::mix(a, b, belly);
        add(a, middle, ends * thick, thick);
        add(middle, b, thick, ends * thick);
    }
};

/// All of him.
std::vector<Limb> anatomy();

/// His skin as a mesh that follows the bones; cells of the size given, in metres.
Primitive skin(const ImplicitBody& body, double cell, Index material);

}  // namespace pentaprism::builtin::barbarian
