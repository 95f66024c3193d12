// Bounds made sixteen at a time keep all that the scalar ones keep: on every CPU target, each triangle and segment,
// with no smaller rectangle and no nearer claim, and never a side that the scalar test does not promise.
#include <gtest/gtest.h>

#include "bin/bins.h"
#include "support/isa.h"
#include "support/soup.h"

namespace pentaprism {
namespace {

using support::effort;
using support::has_isa;
using support::make_soup;
using support::Random;
using support::Soup;
using support::UseIsa;

Bins bins_on(const char* isa, const Frame& frame, const PixelRect& limits) {
    const UseIsa use(isa);
    return Bins(frame, 32, limits);
}

// Returns how many bounds were compared.
std::size_t expect_no_less(const Frame& frame, const PixelRect& limits, const char* isa) {
    const Bins scalar = bins_on("scalar", frame, limits), vectors = bins_on(isa, frame, limits);
    std::size_t next = 0;
    const auto binned = vectors.triangles();
    for (const BinnedTriangle& want : scalar.triangles()) {
        const auto before = [&](const BinnedTriangle& b) {
            return b.triangle < want.triangle || (b.triangle == want.triangle && b.segment < want.segment);
        };
        while (next < binned.size() && before(binned[next])) ++next;
        const bool there =
            next < binned.size() && binned[next].triangle == want.triangle && binned[next].segment == want.segment;
        EXPECT_TRUE(there) << isa << ": lost triangle " << want.triangle << ", segment " << want.segment;
        if (!there) continue;
        const BinnedTriangle& have = binned[next];
        EXPECT_TRUE(have.x0 <= want.x0 && have.x1 >= want.x1 && have.y0 <= want.y0 && have.y1 >= want.y1)
            << isa << ": triangle " << want.triangle << " has " << have.x0 << ".." << have.x1 << " x " << have.y0
            << ".." << have.y1 << ", needs " << want.x0 << ".." << want.x1 << " x " << want.y0 << ".." << want.y1;
        EXPECT_LE(have.nearest_w, want.nearest_w * (1.0f + 0x1p-22f)) << isa << ": triangle " << want.triangle;
        EXPECT_TRUE(have.facing == want.facing || have.facing == Facing::kMixed)
            << isa << ": triangle " << want.triangle << " shows side " << static_cast<int>(have.facing) << ", not "
            << static_cast<int>(want.facing);
    }
    return scalar.triangles().size();
}

TEST(BinsTwins, KeepAllThatScalarBoundsKeep) {
    Random r(41);
    std::size_t compared = 0;
    for (int i = 0; i < 60 * effort(); ++i) {
        Soup s;
        s.motion = r.chance(0.7);
        s.defocus = r.chance(0.7);
        s.single_sided = r.chance(0.5);
        s.ratio = r.chance(0.7) ? 1.0 : r.range(0.5, 2.0);
        constexpr double kMagnify[] = {1, 1, 1e-9, 1e-4, 1e4, 1e9, 7e10};
        s.magnify = kMagnify[r.below(7)];
        s.triangles = r.between(1, 40);
        const Frame frame = make_soup(r, s);
        const int x0 = r.below(40), y0 = r.below(30);
        const PixelRect limits{x0, r.between(x0 + 1, s.width), y0, r.between(y0 + 1, s.height)};
        for (const char* isa : {"avx512", "avx2", "neon"})
            if (has_isa(isa)) compared += expect_no_less(frame, limits, isa);
        if (::testing::Test::HasFailure()) break;
    }
    if (has_isa("avx512") || has_isa("avx2") || has_isa("neon")) {
        EXPECT_GT(compared, 10000u);
    }
}

}  // namespace
}  // namespace pentaprism
