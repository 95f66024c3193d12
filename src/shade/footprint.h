#pragma once
// How much of a texture one shading point stands for: a covariance ellipse (docs/learn/shading.md).

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "scene/texture.h"

namespace pentaprism {

/// Covariance of the texture coordinates that a shading point stands for: its pixel, its motion and its lens disk.
struct TextureFootprint {
    float uu = 0.0f, uv = 0.0f, vv = 0.0f;
    void add(glm::vec2 axis, float variance) {
        uu += variance * axis.x * axis.x;
        uv += variance * axis.x * axis.y;
        vv += variance * axis.y * axis.y;
    }
};

/// A texture of a material, ready for look-ups.
struct BoundTexture {
    const Pyramid* pyramid = nullptr;  ///< null: no texture
    TextureRef ref;
    glm::vec4 matrix{1.0f, 0.0f, 0.0f, 1.0f};  ///< uv_matrix(ref)
    int set = 0;                               ///< texture coordinates, 0 or 1

    /// Mean over the footprint: up to 16 trilinear taps along its longer axis, each as wide as the shorter one.
    glm::vec4 sample(glm::vec2 uv, const TextureFootprint& footprint) const;
};

}  // namespace pentaprism
