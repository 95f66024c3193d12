#include "resolve/aov_film.h"

#include <algorithm>

namespace pentaprism {

int channel_count(std::span<const Aov> aovs) {
    int channels = 0;
    for (const Aov aov : aovs) channels += static_cast<int>(aov_info(aov).channels.size());
    return channels;
}

TileAovs::TileAovs(std::span<const Aov> aovs, const AovSources& sources, const PixelRect& delivered)
    : aovs_(aovs.begin(), aovs.end()), sources_(sources), delivered_(delivered) {}

void TileAovs::resolve(const SampleTable& samples, const Hits& hits, const TileShade& shade, Worker& worker,
                       TileSums& sums) const {
    const Tile& tile = sums.tile;
    const int channels = channel_count(aovs_);
    if (worker.resolvers.empty())
        for (const Aov aov : aovs_) worker.resolvers.push_back(make_resolver(aov, sources_));
    worker.surfaces.start(*sources_.scene, tile);
    std::vector<SampleVector> room;
    for (int by = tile.y0 / kBlockSize; by * kBlockSize < tile.y1; ++by)
        for (int bx = tile.x0 / kBlockSize; bx * kBlockSize < tile.x1; ++bx) {
            if (!tile.wants(bx, by)) continue;
            worker.order.read(samples, bx, by);
            const std::span<const SampleVector> vectors = samples.block(bx, by, room);
            for (int lane = 0; lane < kLanes; ++lane) {
                const int px = bx * kBlockSize + lane % kBlockSize, py = by * kBlockSize + lane / kBlockSize;
                if (px < std::max(tile.x0, delivered_.x0) || px >= std::min(tile.x1, delivered_.x1)) continue;
                if (py < std::max(tile.y0, delivered_.y0) || py >= std::min(tile.y1, delivered_.y1)) continue;
                resolve_pixel(samples, hits, shade, px, py, worker, vectors, &sums.aovs[sums.own(px, py) * channels]);
            }
        }
}

void TileAovs::resolve_pixel(const SampleTable& samples, const Hits& hits, const TileShade& shade, int px, int py,
                             Worker& worker, std::span<const SampleVector> vectors, float* out) const {
    const int lane = py % kBlockSize * kBlockSize + px % kBlockSize;
    for (const auto& resolver : worker.resolvers) resolver->begin(px, py);
    for (int index = 0; index < samples.spp(); ++index) {
        const int slot = worker.order.slots(lane)[index];
        const std::size_t at = hits.entry(px, py, slot);
        if (hits.triangle[at] == kNoTriangle) {
            for (const auto& resolver : worker.resolvers) resolver->miss(sources_.background);
            continue;
        }
        const SampleVector& v = vectors[slot];
        const SurfaceSample sample = worker.surfaces.at(hits.triangle[at], hits.depth[at],
                                                        {v.x[lane], v.y[lane], v.u[lane], v.v[lane], v.t[lane]});
        const glm::vec3 color(shade.colors[shade.point_of_sample[at]]);
        for (const auto& resolver : worker.resolvers) resolver->hit(sample, color);
    }
    for (std::size_t i = 0; i < aovs_.size(); ++i) {
        worker.resolvers[i]->end(out);
        out += aov_info(aovs_[i]).channels.size();
    }
}

AovFilm::AovFilm(int channels, int x0, int x1, int rows) : channels_(channels), x0_(x0), width_(x1 - x0), rows_(rows) {
    pixels_.assign(static_cast<std::size_t>(width_) * rows_ * channels_, 0.0f);
}

void AovFilm::add(const TileSums& from, int y0, int y1) {
    const Tile& tile = from.tile;
    const int first = std::max(tile.x0, x0_), last = std::min(tile.x1, x0_ + width_);
    if (channels_ == 0 || first >= last) return;
    for (int y = std::max(tile.y0, y0); y < std::min(tile.y1, y1); ++y)
        std::copy_n(&from.aovs[from.own(first, y) * channels_], (last - first) * channels_, pixel(first, y));
}

std::span<const float> AovFilm::rows(int first, int count) {
    if (channels_ == 0) return {};
    const std::size_t n = static_cast<std::size_t>(count) * width_;
    delivered_.resize(n * channels_);
    std::size_t i = 0;
    for (int y = first; y < first + count; ++y)
        for (int x = x0_; x < x0_ + width_; ++x, ++i) {
            const float* from = pixel(x, y);
            for (int c = 0; c < channels_; ++c) delivered_[c * n + i] = from[c];
        }
    return delivered_;
}

}  // namespace pentaprism
