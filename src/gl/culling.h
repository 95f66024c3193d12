#pragma once
// `--culling` as a shader: each test is its twin src/cull/<stem>.glsl, which defines
//
//     bool <stem>_keeps(LocalTriangle T, Footprint footprint, LocalSample sampled)
//
// prepare() and keeps() of the C++ test in one.

#include <string>
#include <vector>

#include "cull/cull_choice.h"

namespace pentaprism::gl {

/// Names of the tests that have a twin.
std::vector<std::string> culling_names();

/// `auto` is bbox here: asking costs more than the exact test where each sample is an invocation of its own. Throws
/// Error(kUsage) for a test without a twin and for buckets, of which a sample on its own is none.
Culling parse_gl_culling(const std::string& choice);

/// Whether hulls can be drawn instead of boxes: no pixel outside them is kept.
bool asks_hull_of_pixels(const Culling& culling);

/// Shader text that defines `bool culling_keeps(LocalTriangle T, LocalSample sampled, ivec2 place)`: all steps;
/// `place`: the sample's pixel in its cell.
std::string culling_shader(const Culling& culling);

/// The stem of a test's files.
std::string stem_of(const std::string& name);

}  // namespace pentaprism::gl
