#include "shade/shadow_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/aligned.h"

namespace pentaprism {
namespace {

constexpr int kFinest = -24;  // exponent of a texel's size
constexpr int kPageCells = 16;
constexpr int kLevels = (ShadowMap::kCoarsest - kFinest + 1) * kLimits;

// What all cells share in which nothing is.
const std::vector<float> kEmptyCell(ShadowSamples::kPerCell, INFINITY);

// Keeps what is there already: several threads may make the same thing, and all makes are equal.
template <class T>
T* publish(std::atomic<T*>& place, std::unique_ptr<T> made) {
    T* expected = nullptr;
    if (place.compare_exchange_strong(expected, made.get(), std::memory_order_acq_rel)) return made.release();
    return expected;
}

}  // namespace

struct ShadowMap::Page {
    std::array<Cell, kPageCells * kPageCells> cells;
};

struct ShadowMap::Level {
    explicit Level(int pages) : pages_across(pages), pages(std::make_unique<std::atomic<Page*>[]>(pages * pages)) {}
    ~Level() {
        for (int i = 0; i < pages_across * pages_across; ++i) delete pages[i].load();
    }
    int pages_across;
    std::unique_ptr<std::atomic<Page*>[]> pages;
};

ShadowMap::ShadowMap(const WorldMotion& world, const ShadowSamples& samples, ShadowCellStore& store,
                     const LightView& view, int width)
    : world_(world),
      samples_(samples),
      store_(store),
      find_(find_casters()),
      draw_(draw_shadow_cell()),
      view_(view),
      width_(width),
      // Half a level of the finest texels holds the widest tangent.
      least_exponent_(view.perspective ? -std::ilogb(0.5 * width / kWidestTangent) : kFinest),
      levels_(std::make_unique<std::atomic<Level*>[]>(kLevels)) {}

ShadowMap::~ShadowMap() {
    for (int i = 0; i < kLevels; ++i) delete levels_[i].load();
}

void ShadowMap::prepare() const {
    std::call_once(made_, [this] { make(true); });
}

const Casters& ShadowMap::casters() const {
    std::call_once(made_, [this] { make(false); });
    return casters_;
}

void ShadowMap::make(bool parallel) const {
    casters_ = make_casters(world_, view_, parallel);
}

int ShadowMap::exponent_of(float texel) const {
    return texel > 0.0f && std::isfinite(texel) ? std::clamp(binary_exponent(texel), least_exponent_, kCoarsest)
                                                : kCoarsest;
}

ShadowMap::Level& ShadowMap::level(int exponent, int limit) const {
    std::atomic<Level*>& place = levels_[(exponent - kFinest) * kLimits + limit];
    if (Level* level = place.load(std::memory_order_acquire)) return *level;
    return *publish(place, std::make_unique<Level>(width_ / kCellSize / kPageCells));
}

ShadowMap::Cell& ShadowMap::cell(Level& level, int cx, int cy) const {
    std::atomic<Page*>& place = level.pages[cy / kPageCells * level.pages_across + cx / kPageCells];
    Page* page = place.load(std::memory_order_acquire);
    if (page == nullptr) page = publish(place, std::make_unique<Page>());
    return page->cells[cy % kPageCells * kPageCells + cx % kPageCells];
}

const float* ShadowMap::depths(int exponent, int limit, int cx, int cy) const {
    Cell& here = cell(level(exponent, limit), cx, cy);
    if (const float* known = store_.find(here.depths)) return known;
    if (here.empty.load(std::memory_order_relaxed)) return kEmptyCell.data();
    static thread_local AlignedVector<float> made(ShadowSamples::kPerCell);
    ++cells_rendered_;
    if (render(exponent, limit, cx, cy, made.data())) return store_.keep(here.depths, made.data());
    here.empty.store(true, std::memory_order_relaxed);
    return kEmptyCell.data();
}

bool ShadowMap::is_empty(const float* depths) {
    return depths == kEmptyCell.data();
}

// False if nothing is in the cell.
bool ShadowMap::render(int exponent, int limit, int cx, int cy, float* bounds) const {
    const int middle = width_ / kCellSize / 2;
    const float size = std::ldexp(static_cast<float>(kCellSize), exponent);
    const float left = static_cast<float>(cx - middle) * size, top = static_cast<float>(middle - cy) * size;
    static thread_local std::vector<std::uint32_t> room;
    const std::size_t found = find_(casters(), {left, left + size, top - size, top, limit}, room);
    if (found == 0) return false;
    static thread_local AlignedVector<float> depths(ShadowSamples::kPerCell);
    const std::span<const std::uint32_t> list(room.data(), found);
    draw_({casters(), list, samples_, cx, cy, width_, std::ldexp(1.0f, -exponent)}, depths.data(), bounds);
    return std::any_of(bounds, bounds + ShadowSamples::kPerCell, [](float depth) { return depth < INFINITY; });
}

}  // namespace pentaprism
