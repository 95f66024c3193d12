#include "cases.h"

#include <cstdlib>
#include <filesystem>

namespace pentaprism::bench {

std::vector<Case> cases() {
    std::vector<Case> all = {{"hand/defocus", "builtin:hand", Effect::kDefocus, 24},
                             {"car/motion", "builtin:car", Effect::kMotion, 24},
                             {"fairy-forest/both", "builtin:fairy-forest", Effect::kBoth, 24},
                             {"fairy-forest/both-x2", "builtin:fairy-forest", Effect::kBothTwice, 24},
                             {"fairy-forest/still", "builtin:fairy-forest", Effect::kStill, 24},
                             {"bridge/motion", "builtin:bridge", Effect::kMotion, 24},
                             {"bridge/both", "builtin:bridge", Effect::kBoth, 24}};
    if (const char* folder = std::getenv("PENTAPRISM_SCENES")) {
        const std::string root = std::string(folder) + "/";
        for (const Case& real :
             {Case{"forest/both", root + "forest/forest.glb", Effect::kBoth, 24, 0.010888, 6.0, "dolly"},
              Case{"insects/both", root + "insects/insects.glb", Effect::kBoth, 24, 0.004849, 1.2, "macro"},
              Case{"torcs-race/both", root + "torcs/torcs-race.glb", Effect::kBoth, 24, 0.008872, 15.0, "chase"},
              Case{"apartment/both", root + "environment/apartment.glb", Effect::kBoth, 24, 0.01}})
            if (std::filesystem::exists(real.source)) all.push_back(real);
    }
    // A scene of the user's own, such as a forest of millions of triangles.
    if (const char* large = std::getenv("PENTAPRISM_BENCH_SCENE")) {
        all.push_back({"large/motion", large, Effect::kMotion, 24});
        all.push_back({"large/both", large, Effect::kBoth, 24, 0.010888, 6.0});
    }
    return all;
}

RenderSettings settings_for(const Case& which, const Scene& scene) {
    RenderSettings settings;
    settings.image.width = 1024;
    settings.image.height = 768;
    settings.image.spp = 16;
    settings.method.threads = 1;
    settings.camera.camera = which.camera;
    const LensInfo lens = scene.cameras.empty() ? LensInfo{} : scene.cameras.front().lens;
    const bool twice = which.effect == Effect::kBothTwice;
    settings.camera.defocus = which.effect != Effect::kStill && which.effect != Effect::kMotion;
    settings.shutter.motion_blur = which.effect != Effect::kStill && which.effect != Effect::kDefocus;
    if (which.lens_radius > 0.0) settings.camera.lens_radius = which.lens_radius;
    if (which.focus_distance > 0.0) settings.camera.focus_distance = which.focus_distance;
    if (twice && lens.fstop) settings.camera.fstop = 0.5 * *lens.fstop;
    if (twice) settings.shutter.shutter = 2.0 * lens.shutter.value_or(0.5);
    return settings;
}

}  // namespace pentaprism::bench
