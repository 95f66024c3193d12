#pragma once
// The seven amounts of blur, as settings of a scene.

#include <pentaprism/bench.h>

namespace pentaprism {

/// A scene's own lens and shutter, or the stated defaults: f/2.8, half a frame.
BenchScene describe_scene(const Scene& scene, const RenderSettings& settings, double frame);

/// `settings` with the blur of the effect.
RenderSettings with_effect(RenderSettings settings, const BenchScene& scene, const BenchEffect& effect);

/// Throws Error(kUsage) for a name that bench_effects() does not have.
BenchEffect find_effect(const std::string& name);

}  // namespace pentaprism
