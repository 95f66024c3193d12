#pragma once
// Cells of lens and shutter with a screen box each, for `interval` and `interval-fine`.
//
// Known as Pixar's interval method; Fatahalian, Luong, Boulos, Akeley, Mark, Hanrahan 2009 (Data-Parallel Rasterization
// of Micropolygons with Defocus and Motion Blur) describe it. Within a cell the triangle is seen only in the box of
// docs/develop/algorithms.md 3.2 restricted to the cell's ranges (proof there); a sample is tested if its pixel or
// other footprint touches the box of its cell. The literature bounds x and w by intervals and divides; we take the box
// of the six points at the ends of the cell, which is tighter. A triangle that reaches the camera plane gets one box
// for all cells, the exact test's own.
//
// Rounding: the box carries the slack of 4.2; cells are 1e-5 larger than the samples that belong to them.

#include <algorithm>
#include <bitset>

#include "bound/local_bounds.h"
#include "cull/cull_test.h"

namespace pentaprism {

/// kTime x kLens x kLens cells of equal size. Which one a sample is in is found by rounding, so a cell's own range is
/// taken a little larger than it is.
template <int kTime, int kLens>
struct Cells {
    static constexpr int kCount = kTime * kLens * kLens;

    static constexpr CullTest test(const char* name, const char* paper) {
        return {name, paper, prepare, keeps, Grain::kPixel, begin};
    }

    struct Setup {
        LocalBox boxes[kCount];
        float v0, per_v;
    };
    struct State {
        std::bitset<kCount> kept;
    };

    static bool begin(const LocalTriangle& T, const Footprint& picture, CullSetup& memory) {
        Setup& setup = memory.as<Setup>();
        const PictureRect rect{picture.x0, picture.x1, picture.y0, picture.y1};
        const Domain& whole = picture.domain;
        setup.v0 = whole.v0;
        setup.per_v = kLens / (whole.v1 - whole.v0);
        bool any = false;
        for (int k = 0; k < kCount; ++k) {
            const int t = k / (kLens * kLens), v = k / kLens % kLens, u = k % kLens;
            Domain cell{};
            part(whole.u0, whole.u1, u, kLens, cell.u0, cell.u1);
            part(whole.v0, whole.v1, v, kLens, cell.v0, cell.v1);
            part(whole.t0, whole.t1, t, kTime, cell.t0, cell.t1);
            const SegmentDomain domain = segment_domain(T, cell);
            setup.boxes[k] = domain.empty() ? LocalBox() : local_bounds(T, domain, rect);
            any = any || !setup.boxes[k].empty();
        }
        return any;
    }

    static bool prepare(const LocalTriangle&, const Footprint& f, CullState& memory) {
        const Setup& setup = memory.setup->as<Setup>();
        State& state = memory.as<State>();
        for (int k = 0; k < kCount; ++k)
            state.kept[k] = !setup.boxes[k].empty() && setup.boxes[k].meets(f.x0, f.x1, f.y0, f.y1);
        return state.kept.any();
    }

    static bool keeps(const CullState& memory, const LocalSample& s) {
        const Setup& setup = memory.setup->as<Setup>();
        const int u = cell((s.u + 1.0f) * (0.5f * kLens), kLens), v = cell((s.v - setup.v0) * setup.per_v, kLens),
                  t = cell(s.t * kTime, kTime);
        return memory.as<State>().kept[(t * kLens + v) * kLens + u];
    }

  private:
    static int cell(float place, int n) { return std::clamp(static_cast<int>(place), 0, n - 1); }

    static void part(float low, float high, int k, int n, float& from, float& to) {
        constexpr float kOut = 1e-5f;
        const float step = (high - low) / static_cast<float>(n);
        from = low + step * static_cast<float>(k) - kOut;
        to = low + step * static_cast<float>(k + 1) + kOut;
    }
};

}  // namespace pentaprism
