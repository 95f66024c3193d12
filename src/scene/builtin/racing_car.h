#pragma once
// The racing car of the sixties that `car` and `race` show: cigar body with a livery, driver, trumpets and exhausts,
// wishbones, wire wheels of which every spoke is modelled. About 17,000 triangles each; in metres, nose towards +x.

#include <functional>
#include <string>

#include "scene/builtin/assembly.h"

namespace pentaprism::builtin {

struct RacingCarLook {
    std::string name, livery;  ///< of its nodes; of its texture
    glm::dvec3 paint, stripe;  ///< linear colours
    int number;                ///< on the roundels, 0 to 9
    glm::dvec3 helmet;
};

struct RacingCarMotion {
    std::function<glm::dvec3(double t)> place;    ///< where the middle between the axles touches the road
    std::function<glm::dquat(double t)> heading;  ///< empty: the nose stays towards +x
    double speed;                                 ///< metres per second that the wheels roll
    double steer = 0.0;                           ///< radians that the front wheels point to the left
    double lean_deg = 0.0;                        ///< that the body leans to its right
    double phase = 0.0;                           ///< radians of its shivers, so that no two shiver alike
};

class RacingCars {
  public:
    /// Adds what all cars share to the scene: materials, wheels, the soft shadow below.
    explicit RacingCars(Assembly& scene);

    /// One more car at the top of the scene; returns its node.
    Index add(const RacingCarLook& look, const RacingCarMotion& motion);

  private:
    Assembly& scene_;
    Index fittings_, glass_, shadow_, front_wheel_, rear_wheel_;
};

}  // namespace pentaprism::builtin
