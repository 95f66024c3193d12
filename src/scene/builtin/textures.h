#pragma once
// Procedural textures, 8-bit sRGB with alpha, at most 512 texels wide.

#include <functional>
#include <pentaprism/scene.h>

namespace pentaprism::builtin {

/// Linear colour and alpha of the point (u right, v down, both 0 to 1).
using Texel = std::function<glm::dvec4(double u, double v)>;

/// A picture of the function, each texel the mean of `taps` x `taps` points.
Image paint(std::string name, int width, int height, int taps, const Texel& texel);

/// Two linear colours in `squares` x `squares` fields with hard edges.
Image checker_texture(std::string name, int size, int squares, glm::dvec3 dark, glm::dvec3 light);

/// Bands of two linear colours across the diagonal, repeating.
Image stripe_texture(std::string name, int size, int stripes, glm::dvec3 dark, glm::dvec3 light);

/// Rings of two linear colours about the centre, within a frame of the first.
Image target_texture(std::string name, int size, int rings, glm::dvec3 dark, glm::dvec3 light);

/// A blot of one colour, opaque in the middle and clear at the rim.
Image soft_spot_texture(std::string name, glm::dvec3 color, double alpha);

/// Grey furrows along v, to be tinted by vertex colours.
Image bark_texture();

/// Grey crumbs and flecks, repeating, to be tinted by vertex colours.
Image litter_texture();

/// A pale midrib (u = 0.5) with side veins, nearly white: to be tinted by vertex colours. v runs from stalk to tip.
Image leaf_texture();

/// An insect's wing, u from leading to trailing edge, v from root to tip: dark veins around clear cells (low alpha).
Image wing_texture(std::string name, glm::dvec3 membrane, glm::dvec3 vein, double membrane_alpha);

/// 8-bit sRGB code of a linear value in [0, 1].
std::uint8_t srgb_code(double linear);

}  // namespace pentaprism::builtin
