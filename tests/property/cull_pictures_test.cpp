// Every culling test, at every footprint and joined with others, gives the picture that `none` gives, bit for bit.
#include <gtest/gtest.h>
#include <pentaprism/render.h>
#include <string>

#include "support/soup.h"
#include "support/visible.h"

namespace pentaprism {
namespace {

using support::make_soup;
using support::Random;
using support::Soup;
using support::Visible;

std::vector<std::string> choices() {
    std::vector<std::string> all = {"improved-dual-space@tile+improved-dual-space@pixel",
                                    "improved-dual-space@tile+hyperplane",
                                    "improved-dual-space+hyperplane@tile",
                                    "clip-space+half-space+interval",
                                    "hull+facing@bucket+hyperplane@bucket",
                                    "hierarchical@tile+dual-space@pixel+ut-vt-lines@bucket",
                                    "gamma-ranges+clip-space-affine@tile"};
    for (const CullTest* test : cull_table())
        if (test->conservative)
            for (const char* grain : {"tile", "pixel", "bucket"}) all.push_back(std::string(test->name) + "@" + grain);
    return all;
}

class EveryCulling : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryCulling, ShowsWhatNoneShows) {
    Random r(51);
    for (int i = 0; i < 4 * support::effort(); ++i) {
        Soup soup;
        soup.motion = i % 4 != 1;
        soup.defocus = i % 4 != 2;
        soup.orthographic = i % 4 == 3;
        soup.single_sided = i % 2 == 1;
        soup.ratio = i % 2 == 0 ? 1.0 : 1.6;
        soup.triangles = 3;
        soup.width = r.between(30, 50);
        soup.height = r.between(20, 40);
        const Frame frame = make_soup(r, soup);
        const SampleTable samples(
            4, 3, frame.view.lens,
            soup.motion ? (soup.defocus ? Grouping::kBoth : Grouping::kMotion) : Grouping::kDefocus);
        const Visible expected(frame, samples, "none"), actual(frame, samples, GetParam().c_str());
        int hits = 0;
        for (int y = 0; y < soup.height; ++y)
            for (int x = 0; x < soup.width; ++x) hits += expected.covered(x, y);
        EXPECT_GT(hits, 0);
        EXPECT_TRUE(actual == expected) << "frame " << i;
    }
}

INSTANTIATE_TEST_SUITE_P(Culling, EveryCulling, ::testing::ValuesIn(choices()), [](const auto& info) {
    std::string name = info.param;
    for (char& c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
    return name;
});

TEST(EveryCulling, RendersABuiltinSceneAlike) {
    const Scene scene = load_scene("builtin:cubes");
    RenderSettings settings;
    settings.image.width = 96;
    settings.image.height = 54;
    settings.image.spp = 4;
    RenderStats stats;
    const Picture fast = render_picture(scene, settings, 3, stats);
    for (const std::string& choice : choices()) {
        settings.method.culling = choice;
        const Picture picture = render_picture(scene, settings, 3, stats);
        EXPECT_TRUE(picture.rgba == fast.rgba && picture.z == fast.z) << choice;
        EXPECT_GT(stats.covered, 0);
    }
}

}  // namespace
}  // namespace pentaprism
