#include "resolve/film.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <optional>
#include <random>

#include "resolve/filter.h"

namespace pentaprism {
namespace {

constexpr int kWidth = 70, kHeight = 45;
constexpr Filter kFilters[] = {Filter::kBox, Filter::kTent, Filter::kGaussian, Filter::kBlackmanHarris};

SampleTable table_of(int spp) {
    return SampleTable(spp, 7, Lens{}, Grouping::kStill);
}

// Colour, or nothing, of each sample of a made-up picture.
using Picked = std::function<std::optional<glm::vec3>(int px, int py, int index)>;

struct ShadedTile {
    Tile tile;
    Hits hits;
    TileShade shade;
};

ShadedTile shaded(const SampleTable& table, Tile tile, const Picked& picked) {
    ShadedTile out{tile, {}, {}};
    out.hits.reset(table.slots(), tile);
    out.shade.point_of_sample.assign(out.hits.depth.size(), kBackground);
    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x)
            for (int index = 0; index < table.spp(); ++index) {
                const auto color = picked(x, y, index);
                if (!color) continue;
                const std::size_t at = out.hits.entry(x, y, table.slot_of(x, y, index));
                out.hits.triangle[at] = 0;
                out.hits.depth[at] = 1.0f + static_cast<float>(index);
                out.shade.point_of_sample[at] = static_cast<std::uint32_t>(out.shade.colors.size());
                out.shade.colors.emplace_back(*color, 1.0f);
            }
    return out;
}

std::vector<Tile> tiles_of(int size, int x0, int y0, int x1, int y1) {
    std::vector<Tile> tiles;
    for (int y = y0 / size * size; y < y1; y += size)
        for (int x = x0 / size * size; x < x1; x += size)
            tiles.push_back({x, y, std::min(x + size, kWidth), std::min(y + size, kHeight)});
    return tiles;
}

struct Result {
    std::vector<float> rgba, z;
    bool operator==(const Result& other) const {
        return rgba.size() == other.rgba.size() &&
               std::memcmp(rgba.data(), other.rgba.data(), rgba.size() * sizeof(float)) == 0 && z == other.z;
    }
};

struct Drawing {
    Filter filter = Filter::kBox;
    glm::vec3 background{0.0f};
    FilmSettings film;
    int tile_size = 32;
    std::uint32_t shuffle = 0;
    Tile rendered{0, 0, kWidth, kHeight};
};

Drawing whole(Filter filter) {
    Drawing drawing;
    drawing.filter = filter;
    drawing.film = {0, 0, kWidth, kHeight, 32, filter_reach(filter), 0.0};
    return drawing;
}

void append(Result& result, const PixelRows& rows) {
    result.rgba.insert(result.rgba.end(), rows.rgba.begin(), rows.rgba.end());
    result.z.insert(result.z.end(), rows.z.begin(), rows.z.end());
}

Result draw(const Drawing& drawing, const SampleTable& table, const Picked& picked) {
    const TileFilter filter(drawing.filter, drawing.background);
    Film film(drawing.film);
    TileSums sums;
    Result result;
    const Tile& all = drawing.rendered;
    for (int y = all.y0 / 32 * 32; y < all.y1; y += 32) {
        const int end = std::min(y + 32, all.y1);
        auto tiles = tiles_of(drawing.tile_size, all.x0, y, all.x1, end);
        std::shuffle(tiles.begin(), tiles.end(), std::mt19937(drawing.shuffle));
        for (const Tile& tile : tiles) {
            const ShadedTile made = shaded(table, tile, picked);
            sums.start(made.tile, filter.reach(), 0);
            filter.add(table, made.hits, made.shade, sums);
            film.add(sums);
        }
        append(result, film.take_rows(end, end == all.y1));
    }
    return result;
}

std::optional<glm::vec3> noise(int px, int py, int index) {
    std::uint32_t hash = static_cast<std::uint32_t>((py * 4096 + px) * 64 + index) * 0x9e3779b1u;
    hash = (hash ^ (hash >> 15)) * 0x846ca68bu;
    if (hash % 3 == 0) return std::nullopt;
    return glm::vec3(hash >> 24, hash >> 16 & 255, hash >> 8 & 255) / 85.0f;
}

TEST(Film, AConstantPictureStaysConstant) {
    for (const int spp : {1, 4, 16}) {
        const SampleTable table = table_of(spp);
        for (const Filter filter : kFilters) {
            const Result result =
                draw(whole(filter), table, [](int, int, int) { return glm::vec3(0.3f, 1.0f, 7.25f); });
            ASSERT_EQ(result.z.size(), static_cast<std::size_t>(kWidth) * kHeight);
            for (std::size_t i = 0; i < result.z.size(); ++i) {
                EXPECT_NEAR(result.rgba[4 * i], 0.3f, 0.3e-6f);
                EXPECT_NEAR(result.rgba[4 * i + 2], 7.25f, 7.25e-6f);
                EXPECT_NEAR(result.rgba[4 * i + 3], 1.0f, 1e-6f);
                EXPECT_EQ(result.z[i], 1.0f);
            }
        }
    }
}

TEST(Film, TileSizeAndOrderDoNotChangeABit) {
    const SampleTable table = table_of(4);
    for (const Filter filter : kFilters) {
        const Result reference = draw(whole(filter), table, noise);
        for (const int size : {8, 16, 32})
            for (const std::uint32_t shuffle : {1u, 2u}) {
                Drawing drawing = whole(filter);
                drawing.tile_size = size;
                drawing.shuffle = shuffle;
                EXPECT_TRUE(draw(drawing, table, noise) == reference) << "tiles of " << size;
            }
    }
}

TEST(Film, ACropEqualsThatPartOfTheWhole) {
    const SampleTable table = table_of(4);
    for (const Filter filter : kFilters) {
        const Result all = draw(whole(filter), table, noise);
        Drawing drawing = whole(filter);
        drawing.film.x0 = 33, drawing.film.x1 = 64, drawing.film.y0 = 9, drawing.film.y1 = 40;
        drawing.rendered = {32, 8, 65, 41};
        // The tiles here are whole ones around the crop and its rim; rows above and beside it are dropped.
        drawing.rendered.y0 = 0, drawing.rendered.x0 = 0, drawing.rendered.x1 = kWidth;
        const Result crop = draw(drawing, table, noise);
        ASSERT_EQ(crop.z.size(), 31u * 31u);
        for (int y = 0; y < 31; ++y)
            EXPECT_EQ(
                std::memcmp(&crop.rgba[4 * 31 * static_cast<std::size_t>(y)],
                            &all.rgba[4 * (static_cast<std::size_t>(y + 9) * kWidth + 33)], 4 * 31 * sizeof(float)),
                0);
    }
}

// Straight from the definition, in double, over all samples whose distance is within the radius.
TEST(Film, EachPixelIsTheWeightedMeanOfTheSamplesWithinTheRadius) {
    const int spp = 4;
    const SampleTable table = table_of(spp);
    for (const Filter filter : kFilters) {
        const Result result = draw(whole(filter), table, noise);
        for (const auto& [px, py] : std::vector<std::pair<int, int>>{{0, 0}, {31, 31}, {32, 32}, {69, 44}, {40, 3}}) {
            double sum = 0.0, alpha = 0.0, weights = 0.0;
            for (int qy = std::max(0, py - 3); qy <= std::min(kHeight - 1, py + 3); ++qy)
                for (int qx = std::max(0, px - 3); qx <= std::min(kWidth - 1, px + 3); ++qx)
                    for (int index = 0; index < spp; ++index) {
                        const SamplePoint s = table.sample(qx, qy, index);
                        const double weight =
                            filter_weight(filter, qx + s.x - px - 0.5) * filter_weight(filter, qy + s.y - py - 0.5);
                        if (filter == Filter::kBox && (qx != px || qy != py)) continue;
                        const auto color = noise(qx, qy, index);
                        weights += weight;
                        if (color) sum += weight * color->x, alpha += weight;
                    }
            const std::size_t at = static_cast<std::size_t>(py) * kWidth + px;
            EXPECT_NEAR(result.rgba[4 * at], sum / weights, 1e-5) << px << ' ' << py;
            EXPECT_NEAR(result.rgba[4 * at + 3], alpha / weights, 1e-6) << px << ' ' << py;
        }
    }
}

TEST(Film, WhatIsNotHitShowsTheBackgroundWithoutAlphaAtInfiniteDepth) {
    const SampleTable table = table_of(1);
    Drawing drawing = whole(Filter::kBlackmanHarris);
    drawing.background = {0.25f, 0.5f, 1.0f};
    drawing.film.exposure = 1.0;
    const Result result = draw(drawing, table, [](int, int, int) { return std::nullopt; });
    EXPECT_NEAR(result.rgba[0], 0.5f, 1e-6f);
    EXPECT_NEAR(result.rgba[2], 2.0f, 1e-6f);
    EXPECT_EQ(result.rgba[3], 0.0f);
    EXPECT_EQ(result.z[0], std::numeric_limits<float>::infinity());
}

TEST(Film, ASampleThatIsNotANumberCountsAsBlackAndSpoilsNothing) {
    const SampleTable table = table_of(1);
    const auto with = [&](float bad) {
        return draw(whole(Filter::kGaussian), table,
                    [bad](int x, int y, int) { return x == 20 && y == 20 ? glm::vec3(bad) : glm::vec3(1.0f); });
    };
    const Result black = with(0.0f);
    EXPECT_LT(black.rgba[4 * (20 * kWidth + 20)], 0.9f);
    EXPECT_TRUE(with(std::nanf("")) == black);
    EXPECT_TRUE(with(std::numeric_limits<float>::infinity()) == black);
}

TEST(Film, TheDepthIsThatOfTheNearestSampleOfThePixelItself) {
    const SampleTable table = table_of(4);
    const Result result =
        draw(whole(Filter::kBlackmanHarris), table, [](int x, int, int index) -> std::optional<glm::vec3> {
            if (x == 10 || index < 2) return std::nullopt;
            return glm::vec3(1.0f);
        });
    EXPECT_EQ(result.z[9], 3.0f);
    EXPECT_EQ(result.z[10], std::numeric_limits<float>::infinity());
}

TEST(Filter, WeightsAreTheStatedFunctions) {
    EXPECT_EQ(filter_weight(Filter::kBox, 0.49), 1.0);
    EXPECT_EQ(filter_weight(Filter::kBox, 0.51), 0.0);
    EXPECT_EQ(filter_weight(Filter::kTent, -0.25), 0.75);
    EXPECT_NEAR(filter_weight(Filter::kGaussian, 0.0), 1.0 - std::exp(-4.5), 1e-15);
    EXPECT_NEAR(filter_weight(Filter::kBlackmanHarris, 0.0), 1.0, 1e-12);
    EXPECT_NEAR(filter_weight(Filter::kBlackmanHarris, 1.5 - 1e-9), 6e-5, 1e-9);
    for (const Filter filter : kFilters) {
        EXPECT_EQ(filter_weight(filter, filter_radius(filter) + 1e-9), 0.0);
        for (const double d : {0.1, 0.4, 0.9, 1.3}) EXPECT_EQ(filter_weight(filter, d), filter_weight(filter, -d));
    }
}

}  // namespace
}  // namespace pentaprism
