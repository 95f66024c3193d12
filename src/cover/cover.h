#pragma once
// Which samples of a tile are covered, by what, how far: fills the tile's Hits. Implementations with the same result,
// bit for bit: one sample at a time with any culling test (the readable truth), vectors of sixteen samples, those
// of one pixel where nothing blurs, and still triangles for samples that share lens position and time. Micropolygons
// are another model, the same up to rounding.

#include <cstdint>
#include <span>
#include <vector>

#include "bin/bins.h"
#include "cover/hits.h"
#include "cull/cull_choice.h"
#include "sample/sample_table.h"

namespace pentaprism {

/// How often each pixel's samples were tested and covered: a picture of what culling costs and saves where. Pixel (px,
/// py) is at py * width + px.
struct CoverMap {
    int width = 0, height = 0;
    std::vector<std::uint32_t> tested, covered;
};

struct TileWork {
    const Frame& frame;
    const SampleTable& samples;
    std::span<const BinnedTriangle> triangles;  ///< of the picture
    std::span<const std::uint32_t> list;        ///< those of this tile, in submission order
    Tile tile;
    CoverMap* map =
        nullptr;         ///< of the whole picture, added to; nullptr: not recorded. cover_vectors() leaves it alone
    float scale = 1.0f;  ///< as localize() takes it; 1 but for shadow maps
};

/// What a tile cost. `tested`: exact 5D tests; `covered`: those that accepted (before depth and alpha). The others are
/// about culling tests, so cover_vectors() leaves them alone: `footprints`: calls of CullTest::prepare, one for each
/// triangle and footprint; `kept_footprints`: those that returned true; `asked`: calls of CullTest::keeps.
struct CoverCounts {
    std::int64_t tested = 0, covered = 0;
    std::int64_t footprints = 0, kept_footprints = 0, asked = 0;
    void add(const CoverCounts& other) {
        tested += other.tested;
        covered += other.covered;
        footprints += other.footprints;
        kept_footprints += other.kept_footprints;
        asked += other.asked;
    }
};

/// `hits` must be reset. Walks sample by sample and asks each step of the culling about its own footprints.
void cover_with_test(const TileWork& work, const Culling& culling, Hits& hits, CoverCounts& counts);

/// The same with one test at its own footprint.
void cover_with_test(const TileWork& work, const CullTest& test, Hits& hits, CoverCounts& counts);

/// The fast path of `--culling auto`, on the CPU target in use (base/cpu.h). Equals cover_with_test with any test.
void cover_vectors(const TileWork& work, Hits& hits, CoverCounts& counts);

/// The same where nothing blurs: the frame has no moving part and a pinhole, and SampleTable::by_pixel() is not empty.
void cover_still(const TileWork& work, Hits& hits, CoverCounts& counts);

/// For sample tables whose pattern is not SamplePattern::kFree: a triangle is placed and boxed once for each triple (u,
/// v, t). `tested` counts the triple's samples in the box. Equals the two above.
void cover_shared(const TileWork& work, Hits& hits, CoverCounts& counts);

/// Triangles diced to micropolygons of about a pixel (cover/dice.h). Differs from the others where rounding at an edge
/// or between two depths decides.
void cover_micropolygons(const TileWork& work, Hits& hits, CoverCounts& counts);

}  // namespace pentaprism
