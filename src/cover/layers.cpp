#include "cover/layers.h"

#include <algorithm>
#include <cmath>

#include "cover/scalar_walk.h"
#include "frame/opacity.h"

namespace pentaprism {
namespace {

constexpr std::size_t kMost = 8, kMostBytes = 64u << 20;

bool in_front(const Fragment& a, const Fragment& b) {
    return a.depth < b.depth || (a.depth == b.depth && a.triangle < b.triangle);
}

}  // namespace

void Layers::reset(std::size_t samples) {
    most_ = wanted_ > 0 ? static_cast<std::size_t>(wanted_)
                        : std::clamp(kMostBytes / (samples * sizeof(Fragment)), std::size_t{1}, kMost);
    fragments_.resize(samples * most_);
    count_.assign(samples, 0);
    left_out_.assign(samples, 0);
    ended_.assign(samples, {-INFINITY, 0, 0.0f});
}

bool Layers::next_pass() {
    bool any = false;
    for (std::size_t sample = 0; sample < count_.size(); ++sample) {
        if (left_out_[sample] != 0) {
            any = true;
            ended_[sample] = fragments(sample).back();
        } else if (count_[sample] != 0) {
            ended_[sample].depth = INFINITY;  // all of it was seen
        }
        count_[sample] = left_out_[sample] = 0;
    }
    return any;
}

void Layers::add(std::size_t sample, const Fragment& fragment) {
    if (!in_front(ended_[sample], fragment)) return;
    Fragment* const list = &fragments_[sample * most_];
    std::uint8_t& count = count_[sample];
    if (count == most_) {
        left_out_[sample] = 1;
        if (!in_front(fragment, list[count - 1])) return;
        --count;
    }
    std::size_t at = count++;
    for (; at > 0 && in_front(fragment, list[at - 1]); --at) list[at] = list[at - 1];
    list[at] = fragment;
}

void cover_layers(const TileWork& work, const Culling& culling, const Hits& behind, Layers& layers,
                  CoverCounts& counts) {
    auto list_fragment = [&](const LocalTriangle& triangle, const SampleHit& hit, const SamplePlace& at) {
        if (!in_front({hit.depth, triangle.triangle, 0.0f}, {behind.depth[at.index], behind.triangle[at.index], 0.0f}))
            return false;
        const float opacity = opacity_at(work.frame, triangle.triangle, hit.barycentrics);
        if (opacity > 0.0f) layers.add(at.index, {hit.depth, triangle.triangle, std::min(opacity, 1.0f)});
        return false;  // what is behind stays what it is
    };
    ScalarWalk(work, culling, behind, counts, list_fragment).cover_all();
}

}  // namespace pentaprism
