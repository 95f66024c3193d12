#pragma once
// The fairy of `fairy-forest`: an implicit body, a skirt of petals, and four veined wings that beat.

#include "scene/builtin/assembly.h"

namespace pentaprism::builtin {

/// Adds her below `parent`. She is 8.5 tall with the wings 6.5 long, looks along +z, stands at the origin; scale with
/// the parent. `beats` is the frequency of the wings in hertz.
void add_fairy(Assembly& assembly, Index parent, double beats);

}  // namespace pentaprism::builtin
