#include "shade/shadow_cell_store.h"

#include <array>
#include <atomic>
#include <gtest/gtest.h>
#include <set>
#include <vector>

#include "base/parallel.h"
#include "support/random.h"

namespace pentaprism {
namespace {

constexpr std::size_t kFloats = 64;
using Depths = std::array<float, kFloats>;

Depths depths_of(std::size_t cell) {
    Depths depths;
    depths.fill(static_cast<float>(cell));
    return depths;
}

bool are_of(const float* depths, std::size_t cell) {
    for (std::size_t i = 0; i < kFloats; ++i)
        if (depths[i] != static_cast<float>(cell)) return false;
    return true;
}

const float* ask(ShadowCellStore& store, std::vector<ShadowCellStore::Cell>& cells, std::size_t i) {
    if (const float* depths = store.find(cells[i])) return depths;
    return store.keep(cells[i], depths_of(i).data());
}

TEST(ShadowCellStore, ForgetsWhatNobodyAskedForLatelyAndUsesItsMemoryAgain) {
    std::vector<ShadowCellStore::Cell> cells(1000);
    ShadowCellStore store(kFloats, 16);
    std::set<const float*> places;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const ShadowCellStore::Visit visit(store);
        EXPECT_TRUE(are_of(ask(store, cells, 0), 0));  // often asked for
        const float* depths = ask(store, cells, i);
        EXPECT_TRUE(are_of(depths, i));
        places.insert(depths);
        EXPECT_EQ(ask(store, cells, i), depths);
    }
    EXPECT_LE(places.size(), 24u);
    const ShadowCellStore::Visit visit(store);
    std::size_t known = 0;
    for (ShadowCellStore::Cell& cell : cells) known += store.find(cell) != nullptr;
    EXPECT_GE(known, 8u);
    EXPECT_LE(known, 16u);
    EXPECT_NE(store.find(cells.front()), nullptr);
    EXPECT_NE(store.find(cells.back()), nullptr);
    EXPECT_EQ(store.find(cells[1]), nullptr);
}

TEST(ShadowCellStore, WhatAVisitWasGivenStaysUntilItEnds) {
    std::vector<ShadowCellStore::Cell> cells(400);
    ShadowCellStore store(kFloats, 4);
    const ShadowCellStore::Visit visit(store);
    std::vector<const float*> given;
    for (std::size_t i = 0; i < 100; ++i) given.push_back(ask(store, cells, i));
    for (std::size_t i = 100; i < cells.size(); ++i) {
        const ShadowCellStore::Visit other(store);
        EXPECT_TRUE(are_of(ask(store, cells, i), i));
    }
    for (std::size_t i = 0; i < given.size(); ++i) {
        EXPECT_TRUE(are_of(given[i], i)) << i;
        EXPECT_EQ(store.find(cells[i]), given[i]) << i;
    }
}

TEST(ShadowCellStore, ThreadsSeeWhatTheyAskedFor) {
    std::vector<ShadowCellStore::Cell> cells(64);
    ShadowCellStore store(kFloats, 8);
    std::atomic<int> wrong = 0;
    parallel_for(100000, [&](std::size_t n) {
        support::Random random(static_cast<std::uint32_t>(n));
        const ShadowCellStore::Visit visit(store);
        std::vector<std::pair<std::size_t, const float*>> given;
        for (int k = 0; k < 6; ++k) {
            const std::size_t i = static_cast<std::size_t>(random.range(0.0, 63.99));
            given.emplace_back(i, ask(store, cells, i));
        }
        for (const auto& [i, depths] : given) wrong += !are_of(depths, i);
    });
    EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace pentaprism
