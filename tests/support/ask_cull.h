#pragma once
// Asking culling tests about single samples, and the footprints they are asked at.

#include <algorithm>
#include <cmath>

#include "cull/cull_choice.h"
#include "support/hard_triangles.h"

namespace pentaprism::support {

/// The whole picture in the case's cell: what begin() is told. A cell at the right or bottom sticks out of the picture,
/// and samples of a case may lie there: the picture is taken larger by a cell on each side.
inline Footprint picture_of(const HardCase& c) {
    const float half_x = 0.5f * static_cast<float>(c.frame.view.width) + kCellSize,
                half_y = 0.5f * static_cast<float>(c.frame.view.height) + kCellSize;
    return {-half_x - c.centre.x,
            half_x - c.centre.x,
            -half_y - c.centre.y,
            half_y - c.centre.y,
            {-1, 1, -c.ratio(), c.ratio(), 0, 1}};
}

/// One test and what it remembers of a triangle.
class Asked {
  public:
    explicit Asked(const CullTest& test) : test_(&test) { state_.setup = &setup_; }

    const CullTest& test() const { return *test_; }

    /// False: the triangle, the footprint or the sample is refused. Triangles are told apart by `serial`.
    bool keeps(const LocalTriangle& triangle, std::uint64_t serial, const Footprint& picture,
               const Footprint& footprint, const LocalSample& sample) {
        if (serial != serial_ || !known_) {
            serial_ = serial;
            known_ = true;
            begun_ = test_->begin == nullptr || test_->begin(triangle, picture, setup_);
        }
        return begun_ && test_->prepare(triangle, footprint, state_) && test_->keeps(state_, sample);
    }
    bool keeps(const HardCase& c, const Footprint& footprint, const LocalSample& sample) {
        return keeps(c.local, c.serial, picture_of(c), footprint, sample);
    }

    Asked(const Asked& other) : Asked(*other.test_) {}
    Asked& operator=(const Asked&) = delete;

  private:
    const CullTest* test_;
    CullSetup setup_;
    CullState state_;
    std::uint64_t serial_ = 0;
    bool known_ = false, begun_ = false;
};

/// Regions of the screen, the lens and the shutter that hold the sample.
enum class Region { kPixel, kBlock, kTile, kAnywhere };
inline constexpr Region kRegions[] = {Region::kPixel, Region::kBlock, Region::kTile, Region::kAnywhere};
inline const char* name_of(Region region) {
    constexpr const char* kNames[] = {"pixel", "block", "tile", "any rectangle"};
    return kNames[static_cast<int>(region)];
}

namespace detail {

inline float limit(Random& r, float limit, float value) {
    return r.chance(0.2) ? value : limit + static_cast<float>(r.unit()) * (value - limit);
}

inline Domain part_of_lens_and_shutter(Random& r, float ratio, const LocalSample& s) {
    const Domain d{limit(r, -1, s.u),    limit(r, 1, s.u), limit(r, -ratio, s.v),
                   limit(r, ratio, s.v), limit(r, 0, s.t), limit(r, 1, s.t)};
    return {std::min(d.u0, s.u), std::max(d.u1, s.u), std::min(d.v0, s.v),
            std::max(d.v1, s.v), std::min(d.t0, s.t), std::max(d.t1, s.t)};
}

}  // namespace detail

/// The aligned square of that many pixels that holds the sample.
inline Footprint square_around(const LocalSample& s, int size, const Domain& domain) {
    const float f = static_cast<float>(size);
    const float x = std::min(std::floor((s.hx + 16) / f) * f, 32 - f) - 16,
                y = std::min(std::floor((s.hy + 16) / f) * f, 32 - f) - 16;
    return {x, x + f, y, y + f, domain};
}

inline Footprint region_around(Random& r, Region region, float ratio, const LocalSample& s) {
    const Domain whole{-1, 1, -ratio, ratio, 0, 1};
    switch (region) {
        case Region::kPixel:
            return square_around(s, 1, whole);
        case Region::kBlock:
            return square_around(s, kBlockSize, detail::part_of_lens_and_shutter(r, ratio, s));
        case Region::kTile:
            return square_around(s, 8 << r.below(3),
                                 r.chance(0.5) ? whole : detail::part_of_lens_and_shutter(r, ratio, s));
        case Region::kAnywhere:
            break;
    }
    const Footprint f{detail::limit(r, -16, s.hx), detail::limit(r, 16, s.hx), detail::limit(r, -16, s.hy),
                      detail::limit(r, 16, s.hy), detail::part_of_lens_and_shutter(r, ratio, s)};
    return {std::min(f.x0, s.hx), std::max(f.x1, s.hx), std::min(f.y0, s.hy), std::max(f.y1, s.hy), f.domain};
}

}  // namespace pentaprism::support
