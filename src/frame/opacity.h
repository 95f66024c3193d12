#pragma once
// Alpha masks and blended surfaces: whether a covered sample of a triangle is really a hit. Asked by the coverage
// stage, the references and later the shadow maps alike.

#include <bit>
#include <cstdint>
#include <glm/vec2.hpp>

#include "frame/frame.h"
#include "sample/sample_table.h"

namespace pentaprism {

/// The samples of a picture, over which thresholds of opacity are stratified: samples per pixel, and the seed of their
/// pattern, so that pictures of other seeds have other thresholds.
struct OpacityPattern {
    int spp;
    std::uint32_t seed;
    bool over_time;  ///< indices are in the order of time, and thresholds are stratified over that: for powers of two

    OpacityPattern(int samples_per_pixel, std::uint32_t of_pattern, bool in_order_of_time = false)
        : spp(samples_per_pixel),
          seed(of_pattern),
          over_time(in_order_of_time && std::has_single_bit(static_cast<unsigned>(samples_per_pixel))) {}
    OpacityPattern(const SampleTable& samples)
        : OpacityPattern(samples.spp(), samples.seed(), samples.is_in_order_of_time()) {}
};

/// MASK: bilinear alpha of mip 0 at the sample's own barycentrics, times factor and vertex colour, reaches the cutoff.
/// Surfaces that let light through: as blended ones, see_through(). BLEND: stochastic transparency (Enderton, Sintorn,
/// Shirley, Luebke 2010): alpha exceeds opacity_threshold(), stratified over the samples of the pixel (Laine & Karras
/// 2011). OPAQUE: true. Thread-safe; no allocation.
bool is_opaque_at(const Frame& frame, std::uint32_t triangle, const float barycentrics[3], int px, int py,
                  int sample_index, const OpacityPattern& pattern);

/// The share of light that the surface stops there: 0 or 1 of a MASK, the alpha of BLEND, less of glass. What
/// is_opaque_at() decides by; it may be above 1.
float opacity_at(const Frame& frame, std::uint32_t triangle, const float barycentrics[3]);

/// Has points that stop a part of the light: is_opaque_at() is a matter of chance there.
bool is_see_through(const Frame& frame, std::uint32_t triangle);

/// What the opacity of one triangle is made of, for those who ask at many points: alpha = factor * (corner colours
/// mixed) * (texture at the mixed, transformed coordinates), in this order of rounding.
struct OpacityTerms {
    AlphaMode mode = AlphaMode::kOpaque;
    float cutoff = 0.5f, factor = 1.0f;
    bool colored = false;
    float color[3] = {1.0f, 1.0f, 1.0f};  ///< alpha of the corners' colours, if `colored`
    const Pyramid* texture = nullptr;     ///< null: counts as `texture_alpha` everywhere
    const TextureRef* ref = nullptr;      ///< of `texture`
    glm::vec2 uv[3] = {};
    float texture_alpha = 1.0f;
    bool glass = false;  ///< light comes through as well: ask is_opaque_at(), which needs what follows
    bool blends = true;  ///< else alpha is a mask or nothing, and glass stops what it does not let through
    float transmission = 0.0f;
    const Pyramid* transmission_texture = nullptr;  ///< in R; null: counts as 1 everywhere
    const TextureRef* transmission_ref = nullptr;
    glm::vec2 transmission_uv[3] = {};
};
OpacityTerms opacity_terms(const Frame& frame, std::uint32_t triangle);

/// What alpha must exceed at a sample of a blended triangle; in [0, 1). By chance in (triangle, pixel, sample index,
/// seed): uniform at each sample, one of a pixel's in each of spp equal intervals, independent between triangles, also
/// those of one mesh: two layers must not hide together. Over time (docs/develop/algorithms.md 8): so also within each
/// run of 4^k indices from a multiple of 4^k on, and within each quarter, sixteenth, ... of [0, 1) over such runs;
/// and at each index the thresholds of the sixteen pixels of a block are in different sixteenths.
float opacity_threshold(std::uint32_t triangle, int px, int py, int sample_index, const OpacityPattern& pattern);

/// Share of samples that see through a thin surface of this transmission (KHR_materials_transmission): as stochastic
/// transparency, less than all, so that some samples are left to show what it reflects. Shading scales that up.
inline float see_through(float transmission) {
    return 0.875f * transmission;
}

/// kSolid promises that is_opaque_at() is true at every point of the triangle, kClear that it is false.
OpacityClass opacity_class(const Frame& frame, std::uint32_t triangle);

}  // namespace pentaprism
