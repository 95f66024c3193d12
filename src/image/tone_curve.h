#pragma once
// From linear light to the 8 bits of a screen.

#include <cstdint>
#include <pentaprism/settings.h>

namespace pentaprism {

/// The sRGB curves (IEC 61966-2-1) on [0, 1].
double srgb_encode(double linear);
double srgb_decode(double encoded);

/// Scene-referred linear to display-referred linear, clipped to [0, 1]; not a number gives 0.
///   kNone    clips
///   kAces    fit of the ACES reference and output transforms by Krzysztof Narkowicz, "ACES Filmic Tone Mapping Curve",
///   2015 kFilmic  John Hable, "Filmic Tonemapping Operators", 2010 (the Uncharted 2 curve: exposure bias 2, white
///   at 11.2)
float tone_map(ToneMap curve, float linear);

/// round(255 * srgb_encode(display)) for display in [0, 1]: by comparison with the 255 values at which it steps, so
/// that it is the same on every machine.
std::uint8_t to_srgb8(float display);

}  // namespace pentaprism
