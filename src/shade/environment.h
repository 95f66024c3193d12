#pragma once
// What surrounds a scene: a picture of all directions (latitude-longitude), or a built-in sky. It is seen where nothing
// else is, and lights what is there: matte surfaces by nine spherical harmonics (Ramamoorthi & Hanrahan 2001), shiny
// ones by levels that were filtered with the lobes of their roughnesses (Karis 2013). A sun in the picture becomes a
// directional light with a shadow: neither the harmonics nor the levels could hold it.

#include <array>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pentaprism {

class Environment {
  public:
    /// Linear radiance of a latitude-longitude picture: rows from the top (up, +y); the middle column looks along -z,
    /// columns to its right along +x.
    struct Map {
        int width = 1, height = 1;
        std::vector<glm::vec3> texels;
        glm::vec3 bilinear(const glm::vec3& direction) const;
    };
    struct Sun {
        glm::vec3 direction, irradiance;  ///< unit, to the sun; of a surface that faces it
    };

    explicit Environment(Map map);

    /// A clear sky over a plain ground, with its sun (Preetham, Shirley, Smits 1999, turbidity 3).
    static Environment sky();

    /// As seen.
    glm::vec3 radiance(const glm::vec3& direction) const { return seen_.bilinear(direction); }

    /// Mean radiance around the normal, weighted by the cosine: what a white matte surface shows. Without the sun.
    glm::vec3 matte(const glm::vec3& normal) const;

    /// Mean radiance around the direction, weighted by the lobe of a surface that is seen along it. Without the sun.
    glm::vec3 shiny(const glm::vec3& direction, float roughness) const;

    const std::optional<Sun>& sun() const { return sun_; }

    /// What matte() and shiny() look up.
    const std::array<glm::vec3, 9>& harmonics() const { return harmonics_; }
    const std::vector<Map>& levels() const { return levels_; }

  private:
    void take_out_sun(Map& map);
    void project(const Map& map);
    void filter(Map map);

    Map seen_;
    std::array<glm::vec3, 9> harmonics_{};
    std::vector<Map> levels_;  // roughness 0, 1/5, ... 1
    std::optional<Sun> sun_;
};

/// "sky", or a .hdr or .exr file. Throws Error(kScene).
std::shared_ptr<const Environment> load_environment(const std::string& name);

}  // namespace pentaprism
