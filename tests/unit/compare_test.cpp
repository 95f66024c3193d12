#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <pentaprism/compare.h>
#include <pentaprism/error.h>

namespace pentaprism {
namespace {

Picture filled(int width, int height, glm::vec3 color) {
    Picture picture;
    picture.width = width;
    picture.height = height;
    for (int i = 0; i < width * height; ++i) picture.rgba.insert(picture.rgba.end(), {color.x, color.y, color.z, 1.0f});
    picture.z.assign(static_cast<std::size_t>(width) * height, 1.0f);
    return picture;
}

TEST(Compare, EqualPicturesDoNotDiffer) {
    Picture picture = filled(40, 30, {0.2f, 0.5f, 0.7f});
    picture.rgba[400] = 0.9f;
    const Comparison c = compare_pictures(picture, picture);
    EXPECT_EQ(c.rmse, 0.0);
    EXPECT_TRUE(std::isinf(c.psnr) && c.psnr > 0.0);
    EXPECT_NEAR(c.ssim, 1.0, 1e-9);
    EXPECT_EQ(c.flip, 0.0);
    EXPECT_EQ(c.max, 0.0);
}

TEST(Compare, AConstantDifferenceIsItsRmse) {
    // sRGB codes 51 and 102 of 255: 0.2 and 0.4.
    const Picture a = filled(20, 20, glm::vec3(0.0331047666f)), b = filled(20, 20, glm::vec3(0.1328683216f));
    const Comparison encoded = compare_pictures(a, b), linear = compare_pictures(a, b, {true});
    EXPECT_NEAR(encoded.rmse, 0.2, 1e-5);
    EXPECT_NEAR(encoded.psnr, 13.9794, 1e-3);
    EXPECT_NEAR(encoded.max, 0.2, 1e-5);
    EXPECT_NEAR(linear.rmse, 0.0997636, 1e-6);
    // SSIM of two constants: (2 x y + c1) / (x^2 + y^2 + c1).
    EXPECT_NEAR(encoded.ssim, (2 * 0.2 * 0.4 + 1e-4) / (0.04 + 0.16 + 1e-4), 1e-4);
}

TEST(Compare, FlipSpansFromNothingToAll) {
    // The paper's scale: black against white is the largest difference in lightness; blue against green sets 1.
    const Picture black = filled(100, 100, glm::vec3(0.0f)), white = filled(100, 100, glm::vec3(1.0f));
    const Picture blue = filled(100, 100, {0, 0, 1}), green = filled(100, 100, {0, 1, 0});
    EXPECT_NEAR(compare_pictures(blue, green).flip, 1.0, 1e-3);
    const double contrast = compare_pictures(black, white).flip;
    EXPECT_GT(contrast, 0.9);
    EXPECT_LT(contrast, 1.0);
    EXPECT_EQ(compare_pictures(white, black).flip, contrast);
}

TEST(Compare, AnEyeForgivesNoiseFinerThanItSees) {
    Picture even = filled(64, 64, glm::vec3(0.5f)), fine = even, coarse = even;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
            for (int c = 0; c < 3; ++c) {
                fine.rgba[4 * (y * 64 + x) + c] += (x + y) % 2 ? 0.1f : -0.1f;
                coarse.rgba[4 * (y * 64 + x) + c] += (x / 16 + y / 16) % 2 ? 0.1f : -0.1f;
            }
    EXPECT_NEAR(compare_pictures(even, fine).rmse, compare_pictures(even, coarse).rmse, 1e-6);
    EXPECT_LT(compare_pictures(even, fine).flip, 0.6 * compare_pictures(even, coarse).flip);
}

TEST(Compare, OtherSizesAreRefusedAndNotANumberIsTold) {
    EXPECT_THROW(compare_pictures(filled(4, 4, {}), filled(4, 5, {})), Error);
    Picture broken = filled(4, 4, {});
    broken.rgba[0] = std::numeric_limits<float>::quiet_NaN();
    const Comparison c = compare_pictures(broken, filled(4, 4, {}));
    EXPECT_EQ(c.not_finite, 1);
    EXPECT_EQ(c.max, 1.0);
}

}  // namespace
}  // namespace pentaprism
