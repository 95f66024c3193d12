#include "shade/environment.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <numbers>
#include <pentaprism/error.h>

namespace pentaprism {
namespace {

Environment::Map filled(int width, const glm::vec3& color) {
    return {width, width / 2, std::vector<glm::vec3>(static_cast<std::size_t>(width) * width / 2, color)};
}

const glm::vec3 kWays[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}, {0.6f, 0.0f, -0.8f}};

TEST(Environment, AConstantOneIsThatConstantForEverySurface) {
    const Environment even(filled(64, {0.5f, 1.0f, 2.0f}));
    EXPECT_FALSE(even.sun());
    for (const glm::vec3& way : kWays) {
        for (const glm::vec3& seen : {even.radiance(way), even.matte(way), even.shiny(way, 0.0f),
                                      even.shiny(way, 0.37f), even.shiny(way, 1.0f)})
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(seen[k], 0.5f * static_cast<float>(1 << k), 0.01f);
    }
}

TEST(Environment, DirectionsAreWhereTheDocumentationSays) {
    Environment::Map map = filled(64, glm::vec3(0.0f));
    for (int y = 0; y < 32; ++y) {
        map.texels[y * 64 + 31] = map.texels[y * 64 + 32] = {1, 0, 0};  // the middle: -z
        map.texels[y * 64 + 47] = map.texels[y * 64 + 48] = {0, 1, 0};  // right of it: +x
    }
    const Environment marked(map);
    EXPECT_GT(marked.radiance({0.0f, 0.1f, -1.0f}).x, 0.9f);
    EXPECT_GT(marked.radiance({1.0f, 0.1f, 0.0f}).y, 0.9f);
    EXPECT_EQ(marked.radiance({0.0f, 0.0f, 1.0f}), glm::vec3(0.0f));
}

TEST(Environment, AHalfWhiteSphereLightsByTheCosine) {
    Environment::Map map = filled(128, glm::vec3(0.0f));
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 128; ++x) map.texels[y * 128 + x] = glm::vec3(1.0f);
    const Environment half(map);
    EXPECT_NEAR(half.matte({0, 1, 0}).x, 1.0f, 0.02f);
    EXPECT_NEAR(half.matte({1, 0, 0}).x, 0.5f, 0.02f);
    EXPECT_NEAR(half.matte({0, -1, 0}).x, 0.0f, 0.02f);
}

TEST(Environment, ASmallBrightSunBecomesALightOfTheSamePower) {
    Environment::Map map = filled(256, glm::vec3(0.1f));
    const int row = 40, column = 128 + 64;  // to the right: +x, upwards
    map.texels[row * 256 + column] = glm::vec3(5000.0f);
    const Environment sunny(map);
    ASSERT_TRUE(sunny.sun());
    const double polar = (row + 0.5) / 128.0 * std::numbers::pi, texel = std::numbers::pi / 128.0;
    EXPECT_NEAR(sunny.sun()->irradiance.x, 5000.0 * texel * texel * std::sin(polar), 3.0);
    EXPECT_NEAR(sunny.sun()->direction.y, std::cos(polar), 0.01);
    EXPECT_GT(sunny.sun()->direction.x, 0.7f);
    EXPECT_GT(sunny.radiance(sunny.sun()->direction).x, 1000.0f);  // still seen
    EXPECT_LT(sunny.matte(sunny.sun()->direction).x, 0.3f);        // but its light comes from the lamp
}

TEST(Environment, TheSkyIsBlueAboveAndItsSunIsUp) {
    const Environment sky = Environment::sky();
    ASSERT_TRUE(sky.sun());
    EXPECT_GT(sky.sun()->direction.y, 0.3f);
    const glm::vec3 up = sky.radiance({0, 1, 0});
    EXPECT_GT(up.z, 1.3f * up.x);
    const float level = 0.3f * sky.sun()->direction.y * sky.sun()->irradiance.x + sky.matte({0, 1, 0}).x;
    EXPECT_GT(level, 0.7f);
    EXPECT_LT(level, 1.5f);
}

TEST(Environment, WhatIsNoPictureIsRefused) {
    EXPECT_THROW(load_environment("does-not-exist.hdr"), Error);
    EXPECT_THROW(load_environment("does-not-exist.exr"), Error);
}

}  // namespace
}  // namespace pentaprism
