#pragma once
// Memory of the drawn cells of all shadow maps of a frame. There is room for so many; then those that no tile asked for
// lately are forgotten, and drawn again, the same, when one asks. Tiles near each other ask for the same cells, so in a
// picture that is shaded row by row few are drawn twice.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

namespace pentaprism {

/// Thread-safe. Cells and the depths in them are the caller's to name: this keeps `floats` floats for each.
class ShadowCellStore {
  public:
    /// A place for the depths of a cell, which lives until the store has forgotten it or is gone.
    class Cell {
        friend class ShadowCellStore;
        std::atomic<const float*> depths_{nullptr};
        std::atomic<std::uint32_t> asked_{0};  // number of the visit that asked last
    };

    /// `most`: cells that are kept; more if visits that last ask for more.
    ShadowCellStore(std::size_t floats, std::size_t most);
    ~ShadowCellStore();
    ShadowCellStore(const ShadowCellStore&) = delete;
    ShadowCellStore& operator=(const ShadowCellStore&) = delete;

    /// Depths that a thread was given stay while a visit lasts that began before. Short ones: what is forgotten during
    /// a visit is free when it ends.
    class Visit {
      public:
        explicit Visit(ShadowCellStore& store);
        ~Visit();
        Visit(const Visit&) = delete;
        Visit& operator=(const Visit&) = delete;

      private:
        ShadowCellStore& store_;
        std::multiset<std::uint32_t>::iterator number_;
    };

    /// During a visit: null if they are to be made.
    const float* find(Cell& cell) const {
        const float* depths = cell.depths_.load(std::memory_order_acquire);
        if (depths != nullptr && cell.asked_.load(std::memory_order_relaxed) != now_.load(std::memory_order_relaxed))
            cell.asked_.store(now_.load(std::memory_order_relaxed), std::memory_order_relaxed);
        return depths;
    }

    /// Keeps a copy of what was made. Returns what is there: of several threads that make the same, the first one's.
    const float* keep(Cell& cell, const float* depths);

  private:
    using Room = std::unique_ptr<float[]>;
    struct Kept {
        Cell* cell;
        Room depths;
        std::uint32_t asked = 0;  // as it was when the oldest were last looked for
    };
    struct Forgotten {
        std::uint32_t before;  // visits with a lower number may still read it
        Room depths;
    };
    void forget_oldest();
    void free_forgotten();

    std::size_t floats_, most_, next_sweep_;
    std::atomic<std::uint32_t> now_{0};  // number of the last visit
    std::mutex mutex_;                   // of all that follows
    std::multiset<std::uint32_t> visits_;
    std::vector<Kept> kept_;
    std::vector<Forgotten> forgotten_;
    std::vector<Room> free_;
};

}  // namespace pentaprism
