#pragma once
// Numbers and Cryptomatte ids of what a frame shows, by object (a node, or one of its instances) and by material.
//
// Friedman & Jones 2015, Cryptomatte (Psyop), specification 1.2: an id is MurmurHash3_32 of the name, kept as the float
// with those bits after one bit of the exponent is turned where it would make an infinity, a NaN or a denormal.

#include <cstdint>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "frame/frame.h"

namespace pentaprism {

/// Things that have names; number 0 is the background and has none.
class NamedIds {
  public:
    /// Adds a thing. Names that are empty or taken get a number behind them: ids tell by name alone.
    std::uint32_t add(const std::string& name, const std::string& unnamed);

    const std::string& name(std::uint32_t number) const { return names_[number - 1]; }
    float cryptomatte_id(std::uint32_t number) const { return number == 0 ? 0.0f : ids_[number - 1]; }

    /// The names as a JSON list, number 1 first.
    std::string json() const;
    /// Attributes of an EXR header for the layers called `layer` ("CryptoObject").
    std::vector<std::pair<std::string, std::string>> cryptomatte_attributes(const std::string& layer) const;

  private:
    std::vector<std::string> names_;
    std::unordered_set<std::string> taken_;
    std::vector<float> ids_;
};

/// Numbers of each part of a frame.
struct FrameIds {
    explicit FrameIds(const Frame& frame);
    NamedIds objects, materials;
    std::vector<std::uint32_t> object_of_part, material_of_part;
};

}  // namespace pentaprism
