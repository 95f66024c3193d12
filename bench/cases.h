#pragma once
// The frames that visibility is timed on: built-in scenes always, real ones where PENTAPRISM_SCENES names their folder.

#include <pentaprism/scene.h>
#include <pentaprism/settings.h>
#include <string>
#include <vector>

namespace pentaprism::bench {

enum class Effect : std::uint8_t { kStill, kMotion, kDefocus, kBoth, kBothTwice };

struct Case {
    std::string name;
    std::string source;  ///< what load_scene() takes
    Effect effect;
    double frame;
    double lens_radius = 0.0;     ///< metres; 0: the scene's own lens
    double focus_distance = 0.0;  ///< metres; 0: the scene's own, else the middle of what is seen
    std::string camera = {};
};

/// All of them; real scenes only if their files are there.
std::vector<Case> cases();

/// 1024x768, 16 samples per pixel, one thread. Doubled effects: the lens's radius and the open time of the shutter.
RenderSettings settings_for(const Case& which, const Scene& scene);

}  // namespace pentaprism::bench
