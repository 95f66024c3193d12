#include "shade/shadow_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>
#include <numeric>

#include "base/parallel.h"
#include "bound/screen_bounds.h"
#include "cover/cover.h"
#include "sample/net.h"

namespace pentaprism {
namespace {

constexpr int kFinest = -24, kCoarsest = 24;  // exponents of a texel's size
constexpr int kPageCells = 16;
constexpr float kLargest = 1e12f;
// Of a receiver's plane beyond its own triangle, texels: in front of it less is believed than behind it.
constexpr float kFarthestBehind = 12.0f, kFarthestBefore = 100.0f;
constexpr float kBias = 0.2f;  // texels
constexpr int kAttempts = 16;  // texels along a moving point's way

// Keeps what is there already: several threads may make the same thing, and all makes are equal.
template <class T>
const T* publish(std::atomic<const T*>& place, std::unique_ptr<const T> made) {
    const T* expected = nullptr;
    if (place.compare_exchange_strong(expected, made.get(), std::memory_order_acq_rel)) return made.release();
    return expected;
}

bool is_within(const glm::vec2& p, float reach) {
    return std::max(std::abs(p.x), std::abs(p.y)) < reach;
}

float outward(double value, double direction) {
    const float rounded = static_cast<float>(value);
    return std::nextafter(rounded, static_cast<float>(direction));
}

}  // namespace

struct ShadowMap::Page {
    std::array<Cell, kPageCells * kPageCells> cells;
    ~Page() {
        for (Cell& cell : cells) {
            delete cell.list.load();
            delete[] cell.depths.load();
        }
    }
};

struct ShadowMap::Level {
    explicit Level(int pages) : pages_across(pages), pages(std::make_unique<std::atomic<Page*>[]>(pages * pages)) {}
    ~Level() {
        for (int i = 0; i < pages_across * pages_across; ++i) delete pages[i].load();
    }
    int pages_across;
    std::unique_ptr<std::atomic<Page*>[]> pages;
};

// A triangle in level-0 units: x, y, w and depth of each corner at the start of the segment, and their change.
struct ShadowMap::Corners {
    glm::vec4 start[3], change[3];
    float segments;
    int segment;
    glm::vec4 at(int corner, float t) const {
        return start[corner] + (t * segments - static_cast<float>(segment)) * change[corner];
    }
};

ShadowMap::ShadowMap(const WorldMotion& world, const Frame& frame, const SampleTable& table, const LightView& view,
                     int width)
    : table_(table),
      axes_(view.axes),
      width_(width),
      levels_(std::make_unique<std::atomic<Level*>[]>(kCoarsest - kFinest + 1)) {
    frame_.scene = frame.scene;
    frame_.textures = frame.textures;
    frame_.view.width = frame_.view.height = width;
    frame_.view.perspective = view.perspective;
    frame_.view.shutter = frame.view.shutter;
    frame_.view.depth_near = view.perspective ? 1e-3 : -1e30;
    frame_.view.depth_far = 1e30;
    frame_.parts = world.parts;
    for (Part& part : frame_.parts) part.two_sided = true;  // a shadow does not ask for the side
    frame_.corners = world.corners;
    frame_.part_of = frame.part_of;
    frame_.pieces = frame.pieces;
    frame_.points.resize(world.points.size());
    if (!view.perspective) frame_.depths.resize(world.points.size());
    parallel_ranges(world.points.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const glm::dvec3 p = glm::dvec3(world.points[i]) - view.position;
            const glm::vec3 seen(glm::dot(p, view.axes[0]), glm::dot(p, view.axes[1]), glm::dot(p, view.axes[2]));
            frame_.points[i] = glm::vec4(seen.x, seen.y, view.perspective ? seen.z : 1.0f, 0.0f);
            if (!view.perspective) frame_.depths[i] = seen.z;
        }
    });
    bound_triangles();

    // Half a level holds the tangent 2, so faces of a cube overlap widely.
    least_exponent_ = view.perspective ? -std::ilogb(static_cast<double>(width / 4)) : kFinest;
    float extent = 0.0f;
    for (const Box& box : boxes_)
        extent = std::max({extent, std::abs(box.x0), std::abs(box.x1), std::abs(box.y0), std::abs(box.y1)});
    root_exponent_ =
        view.perspective ? -4 : std::clamp(std::ilogb(extent / kCellSize + 1e-30f) + 1, kFinest, kCoarsest);
}

ShadowMap::~ShadowMap() {
    for (int i = 0; i <= kCoarsest - kFinest; ++i) delete levels_[i].load();
}

void ShadowMap::bound_triangles() {
    constexpr std::size_t kChunk = 4096;
    const std::size_t count = frame_.triangle_count(), chunks = (count + kChunk - 1) / kChunk;
    std::vector<std::vector<Box>> bounded(chunks);
    const bool perspective = frame_.view.perspective;
    parallel_for(chunks, [&](std::size_t chunk) {
        const std::size_t last = std::min(count, (chunk + 1) * kChunk);
        for (std::size_t i = chunk * kChunk; i < last; ++i) {
            const auto triangle = static_cast<std::uint32_t>(i);
            const Part& part = frame_.parts[frame_.part_of[triangle]];
            for (int segment = 0; segment < (part.moves ? part.segments : 1); ++segment) {
                const MovingTriangle m = moving_triangle(frame_, triangle, segment);
                bool usable = true;
                float nearest = kLargest;
                for (int k = 0; k < 6; ++k) {
                    for (const float v : {m.x[k / 2][k % 2], m.y[k / 2][k % 2], m.z[k / 2][k % 2]})
                        usable = usable && std::abs(v) <= kLargest;
                    nearest = std::min(nearest, m.z[k / 2][k % 2]);
                }
                if (!usable) continue;
                const ScreenBox box = screen_bounds(m, frame_.view.w_near(), 1.0);
                if (box.empty()) continue;
                bounded[chunk].push_back({outward(box.x0, -INFINITY), outward(box.x1, INFINITY),
                                          outward(box.y0, -INFINITY), outward(box.y1, INFINITY),
                                          perspective ? static_cast<float>(box.nearest_w) : nearest, triangle,
                                          static_cast<std::uint16_t>(segment)});
            }
        }
    });
    for (auto& chunk : bounded) boxes_.insert(boxes_.end(), chunk.begin(), chunk.end());
    std::sort(boxes_.begin(), boxes_.end(), [](const Box& a, const Box& b) {
        if (a.nearest != b.nearest) return a.nearest < b.nearest;
        return a.triangle != b.triangle ? a.triangle < b.triangle : a.segment < b.segment;
    });
}

ShadowMap::Level& ShadowMap::level(int exponent) const {
    std::atomic<Level*>& place = levels_[exponent - kFinest];
    if (Level* level = place.load(std::memory_order_acquire)) return *level;
    auto made = std::make_unique<Level>(width_ / kCellSize / kPageCells);
    Level* expected = nullptr;
    return place.compare_exchange_strong(expected, made.get()) ? *made.release() : *expected;
}

ShadowMap::Cell& ShadowMap::cell(Level& level, int cx, int cy) const {
    std::atomic<Page*>& place = level.pages[cy / kPageCells * level.pages_across + cx / kPageCells];
    Page* page = place.load(std::memory_order_acquire);
    if (page == nullptr) {
        auto made = std::make_unique<Page>();
        page = place.compare_exchange_strong(page, made.get()) ? made.release() : page;
    }
    return page->cells[cy % kPageCells * kPageCells + cx % kPageCells];
}

// What may be seen in a cell is among what may be seen in the cell of the next level that holds it.
const ShadowMap::List& ShadowMap::list(int exponent, int cx, int cy) const {
    Cell& here = cell(level(exponent), cx, cy);
    if (const List* known = here.list.load(std::memory_order_acquire)) return *known;
    const int middle = width_ / kCellSize / 2;
    const float size = std::ldexp(static_cast<float>(kCellSize), exponent);
    const float x0 = static_cast<float>(cx - middle) * size, y1 = static_cast<float>(middle - cy) * size;
    auto made = std::make_unique<List>();
    const auto take = [&](std::uint32_t i) {
        const Box& box = boxes_[i];
        if (box.x0 <= x0 + size && box.x1 >= x0 && box.y0 <= y1 && box.y1 >= y1 - size) made->push_back(i);
    };
    if (exponent >= root_exponent_) {
        for (std::uint32_t i = 0; i < boxes_.size(); ++i) take(i);
    } else {
        for (const std::uint32_t i : list(exponent + 1, middle + ((cx - middle) >> 1), middle + ((cy - middle) >> 1)))
            take(i);
    }
    return *publish<List>(here.list, std::move(made));
}

const float* ShadowMap::depths(int exponent, int cx, int cy) const {
    Cell& here = cell(level(exponent), cx, cy);
    if (const float* known = here.depths.load(std::memory_order_acquire)) return known;
    std::unique_ptr<float[]> made = render(exponent, cx, cy, list(exponent, cx, cy));
    ++cells_rendered_;
    const float* expected = nullptr;
    if (here.depths.compare_exchange_strong(expected, made.get(), std::memory_order_acq_rel)) return made.release();
    return expected;
}

std::unique_ptr<float[]> ShadowMap::render(int exponent, int cx, int cy, const List& list) const {
    struct Scratch {
        Hits hits;
        std::vector<BinnedTriangle> binned;
        std::vector<std::uint32_t> order;
    };
    static thread_local Scratch scratch;
    const Tile tile{cx * kCellSize, cy * kCellSize, (cx + 1) * kCellSize, (cy + 1) * kCellSize};
    const PixelRect limits{tile.x0, tile.x1, tile.y0, tile.y1};
    const double scale = std::ldexp(1.0, -exponent);
    scratch.binned.clear();
    for (const std::uint32_t i : list) {
        const Box& box = boxes_[i];
        ScreenBox scaled;
        scaled.x0 = box.x0 * scale, scaled.x1 = box.x1 * scale, scaled.y0 = box.y0 * scale, scaled.y1 = box.y1 * scale;
        const PixelRect rect = covered_pixels(scaled, width_, width_, limits);
        if (rect.empty()) continue;
        scratch.binned.push_back({box.triangle, box.segment, static_cast<std::uint16_t>(rect.x0),
                                  static_cast<std::uint16_t>(rect.x1), static_cast<std::uint16_t>(rect.y0),
                                  static_cast<std::uint16_t>(rect.y1), Facing::kMixed,
                                  frame_.view.perspective ? box.nearest : 1.0f});
    }
    scratch.order.resize(scratch.binned.size());
    std::iota(scratch.order.begin(), scratch.order.end(), 0u);
    scratch.hits.reset(kSamples);
    if (!scratch.binned.empty()) {
        CoverCounts counts;
        // In texels of the level: a power of two, so the numbers are the same.
        cover_vectors(TileWork{frame_, table_, scratch.binned, scratch.order, tile, nullptr, static_cast<float>(scale)},
                      scratch.hits, counts);
    }
    auto out = std::make_unique<float[]>(scratch.hits.depth.size());
    std::copy(scratch.hits.depth.begin(), scratch.hits.depth.end(), out.get());
    return out;
}

ShadowMap::Corners ShadowMap::corners(std::uint32_t triangle, int segment) const {
    const MovingTriangle m = moving_source(frame_, triangle, segment);
    const Part& part = frame_.parts[frame_.part_of[triangle]];
    Corners corners;
    for (int i = 0; i < 3; ++i) {
        corners.start[i] = {m.x[i][0], m.y[i][0], m.w[i][0], m.z[i][0]};
        corners.change[i] = glm::vec4(m.x[i][1], m.y[i][1], m.w[i][1], m.z[i][1]) - corners.start[i];
    }
    corners.segments = static_cast<float>(part.moves ? part.segments : 1);
    corners.segment = part.moves ? segment : 0;
    return corners;
}

float ShadowMap::lit(const ShadowReceiver& receiver, std::uint32_t seed) const {
    const Part& part = frame_.parts[frame_.part_of[receiver.triangle]];
    const int segments = part.moves ? part.segments : 1;
    const auto segment_at = [segments](float t) {
        return std::min(static_cast<int>(t * static_cast<float>(segments)), segments - 1);
    };
    const auto blend = [](const glm::vec3& b, const glm::vec4* v) { return b.x * v[0] + b.y * v[1] + b.z * v[2]; };
    const bool perspective = frame_.view.perspective;
    const glm::vec3 lift = receiver.offset * axes_;  // in light space
    const glm::vec4 offset(lift.x, lift.y, perspective ? lift.z : 0.0f, lift.z);

    // The corners as the quarter begins and ends: straight lines between are near enough to find the texels in which
    // the points are seen.
    const float quarter_begin = static_cast<float>(receiver.quarter) / kSamples;
    Corners moving = corners(receiver.triangle, segment_at(quarter_begin));
    glm::vec4 begin[3], end[3];
    for (int i = 0; i < 3; ++i) begin[i] = end[i] = moving.at(i, quarter_begin) + offset;
    if (part.moves) {
        const float quarter_end = quarter_begin + 1.0f / kSamples;
        const Corners later = corners(receiver.triangle, segment_at(quarter_end));
        for (int i = 0; i < 3; ++i) end[i] = later.at(i, quarter_end) + offset;
    }

    // The level, and coarser if a point would lie beyond its edge.
    const float reach = static_cast<float>(width_ / 2 - kCellSize);
    const float nearest = blend(receiver.points[0], begin).z;
    if (!(nearest > 1e-3f)) return 1.0f;  // behind the light
    const float texel = receiver.texel / nearest;
    int exponent =
        texel > 0.0f && std::isfinite(texel) ? std::clamp(std::ilogb(texel), least_exponent_, kCoarsest) : kCoarsest;
    glm::vec2 from[ShadowReceiver::kPoints], way[ShadowReceiver::kPoints];
    for (;; ++exponent) {
        const float scale = std::ldexp(1.0f, -exponent);
        bool within = true;
        for (int i = 0; i < receiver.count && within; ++i) {
            const glm::vec4 p = blend(receiver.points[i], begin), q = blend(receiver.points[i], end);
            from[i] = glm::vec2(p) * (scale / p.z);
            way[i] = glm::vec2(q) * (scale / q.z) - from[i];
            within = p.z > 0.0f && q.z > 0.0f && is_within(from[i], reach) && is_within(from[i] + way[i], reach);
        }
        if (within) break;
        if (exponent == kCoarsest) return 1.0f;
    }

    const float scale = std::ldexp(1.0f, -exponent), half = 0.5f * static_cast<float>(width_);
    int last_x = -1, last_y = -1, lit = 0;
    const float* depth_of = nullptr;
    const SampleVector* samples = nullptr;
    std::vector<SampleVector> room;  // stays empty: the map's shutter does not roll
    CellCentre centre{0.0f, 0.0f};
    const auto sample_at = [&](const glm::vec2& p) {
        const int px = static_cast<int>(p.x + half), py = static_cast<int>(half - p.y);
        const int cx = px / kCellSize, cy = py / kCellSize;
        if (cx != last_x || cy != last_y) {
            depth_of = depths(exponent, cx, cy);
            samples = table_.cell(cx, cy, room).data();
            centre = cell_centre(frame_.view, cx, cy);
            last_x = cx, last_y = cy;
        }
        const int block = py % kCellSize / kBlockSize * kCellBlocks + px % kCellSize / kBlockSize;
        const int lane = py % kBlockSize * kBlockSize + px % kBlockSize;
        return (block * kSamples + receiver.quarter) * kLanes + lane;
    };
    const std::uint32_t random = mix(seed);
    const glm::vec2 jitter = {static_cast<float>(random & 0xffff) * (0.5f / 65536.0f),
                              static_cast<float>(random >> 16) * (0.5f / 65536.0f)};
    const int taps = receiver.count == 1 ? 2 : 4;
    for (int tap = 0; tap < taps; ++tap) {
        // One place in each quarter of a texel's square around the point (or in two that face each other): with one
        // sample for each texel that is bilinear filtering, on the average.
        const int point = tap % receiver.count, corner = taps == 4 ? tap : 3 * tap;
        const glm::vec3& b = receiver.points[point];
        const glm::vec2 start = from[point] + glm::vec2(jitter.x + 0.5f * static_cast<float>(corner % 2) - 0.5f,
                                                        jitter.y + 0.5f * static_cast<float>(corner / 2) - 0.5f);
        const glm::vec2 path = way[point];
        float tau = 0.25f * static_cast<float>(tap) + 0.5f * jitter.x;
        int at = sample_at(start + tau * path);
        if (std::max(std::abs(path.x), std::abs(path.y)) > 0.5f) {
            // A map sample tells of the point only if the point is there at the sample's time: texels along the way
            // are tried until one is.
            float least = INFINITY;
            glm::vec2 best = start + tau * path;
            for (int attempt = 0; attempt < kAttempts; ++attempt) {
                const glm::vec2 guess = start + tau * path;
                at = sample_at(guess);
                const float then =
                    samples[at / kLanes].t[at % kLanes] * kSamples - static_cast<float>(receiver.quarter);
                const glm::vec2 miss = (then - tau) * path;
                const float distance = std::max(std::abs(miss.x), std::abs(miss.y));
                if (distance < least) least = distance, best = guess;
                if (distance <= 0.5f) break;
                tau += 0.618034f;
                tau -= tau >= 1.0f ? 1.0f : 0.0f;
            }
            at = sample_at(best);
        }
        const float occluder = depth_of[at];
        if (occluder == INFINITY) {
            ++lit;
            continue;
        }
        const SampleVector& s = samples[at / kLanes];
        const int lane = at % kLanes;
        const float t = s.t[lane], sx = centre.x + s.x[lane], sy = centre.y + s.y[lane];
        if (const int segment = segment_at(t); part.moves && segment != moving.segment)
            moving = corners(receiver.triangle, segment);
        // The plane of the triangle at the sample's time, seen where the sample is (as cover/exact.h does).
        glm::vec4 v[3];
        float X[3], Y[3];
        for (int i = 0; i < 3; ++i) {
            v[i] = moving.at(i, t) + offset;
            X[i] = v[i].x * scale - sx * v[i].z;
            Y[i] = v[i].y * scale - sy * v[i].z;
        }
        const float e0 = X[1] * Y[2] - X[2] * Y[1], e1 = X[2] * Y[0] - X[0] * Y[2], e2 = X[0] * Y[1] - X[1] * Y[0];
        const float own = b.x * v[0].w + b.y * v[1].w + b.z * v[2].w;
        const float size = (perspective ? own : 1.0f) / scale;
        float depth = (e0 * v[0].w + e1 * v[1].w + e2 * v[2].w) / ((e0 + e1) + e2);
        if (!std::isfinite(depth)) depth = own;
        depth = std::clamp(depth, own - kFarthestBefore * size, own + kFarthestBehind * size);
        lit += depth <= occluder + kBias * size;
    }
    return static_cast<float>(lit) / static_cast<float>(taps);
}

}  // namespace pentaprism
