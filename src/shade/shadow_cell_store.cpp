#include "shade/shadow_cell_store.h"

#include <algorithm>

namespace pentaprism {

ShadowCellStore::ShadowCellStore(std::size_t floats, std::size_t most)
    : floats_(floats), most_(most), next_sweep_(most) {}

ShadowCellStore::~ShadowCellStore() = default;

// Under the lock, as forgetting is: a visit either counts among those that what is forgotten waits for, or began later
// and finds nothing of it.
ShadowCellStore::Visit::Visit(ShadowCellStore& store) : store_(store) {
    const std::lock_guard lock(store.mutex_);
    number_ = store.visits_.insert(++store.now_);
}

ShadowCellStore::Visit::~Visit() {
    const std::lock_guard lock(store_.mutex_);
    store_.visits_.erase(number_);
    if (!store_.forgotten_.empty()) store_.free_forgotten();
}

const float* ShadowCellStore::keep(Cell& cell, const float* depths) {
    const std::lock_guard lock(mutex_);
    if (const float* known = cell.depths_.load(std::memory_order_relaxed)) return known;
    if (kept_.size() >= next_sweep_) forget_oldest();
    Room room;
    if (free_.empty()) {
        room = std::make_unique_for_overwrite<float[]>(floats_);
    } else {
        room = std::move(free_.back());
        free_.pop_back();
    }
    std::copy_n(depths, floats_, room.get());
    cell.asked_.store(now_.load(std::memory_order_relaxed), std::memory_order_relaxed);
    cell.depths_.store(room.get(), std::memory_order_release);
    kept_.push_back({&cell, std::move(room), 0});
    return kept_.back().depths.get();
}

// A quarter of those kept, but none that a visit which lasts may have asked for.
void ShadowCellStore::forget_oldest() {
    // Others may ask meanwhile, and an order that changes is none.
    for (Kept& kept : kept_) kept.asked = kept.cell->asked_.load(std::memory_order_relaxed);
    const auto last = kept_.begin() + static_cast<std::ptrdiff_t>(kept_.size() / 4);
    std::nth_element(kept_.begin(), last, kept_.end(), [](const Kept& a, const Kept& b) { return a.asked < b.asked; });
    const std::uint32_t now = now_.load(std::memory_order_relaxed), oldest = visits_.empty() ? now : *visits_.begin();
    const auto stay = std::partition(kept_.begin(), last, [&](const Kept& kept) { return kept.asked < oldest; });
    for (auto it = kept_.begin(); it != stay; ++it) {
        it->cell->depths_.store(nullptr, std::memory_order_relaxed);
        forgotten_.push_back({now + 1, std::move(it->depths)});
    }
    kept_.erase(kept_.begin(), stay);
    next_sweep_ = std::max(most_, kept_.size() + most_ / 4);
    free_forgotten();
}

void ShadowCellStore::free_forgotten() {
    const auto is_free = [&](const Forgotten& f) { return visits_.empty() || f.before <= *visits_.begin(); };
    for (Forgotten& f : forgotten_)
        if (is_free(f)) free_.push_back(std::move(f.depths));
    std::erase_if(forgotten_, [](const Forgotten& f) { return f.depths == nullptr; });
}

}  // namespace pentaprism
