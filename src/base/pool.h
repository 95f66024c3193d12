#pragma once
// Scratch memory that threads lend and give back: at most as many objects as threads ever worked at once.

#include <memory>
#include <mutex>
#include <vector>

namespace pentaprism {

template <class T>
class Pool {
  public:
    /// Gives the object back when it goes out of scope.
    class Lease {
      public:
        Lease(Pool& pool, std::unique_ptr<T> object) : pool_(pool), object_(std::move(object)) {}
        ~Lease() {
            const std::lock_guard<std::mutex> lock(pool_.mutex_);
            pool_.free_.push_back(std::move(object_));
        }
        Lease(const Lease&) = delete;
        Lease& operator=(const Lease&) = delete;
        T* operator->() const { return object_.get(); }
        T& operator*() const { return *object_; }

      private:
        Pool& pool_;
        std::unique_ptr<T> object_;
    };

    Lease lease() {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (free_.empty()) return Lease(*this, std::make_unique<T>());
        std::unique_ptr<T> object = std::move(free_.back());
        free_.pop_back();
        return Lease(*this, std::move(object));
    }

  private:
    std::mutex mutex_;
    std::vector<std::unique_ptr<T>> free_;
};

}  // namespace pentaprism
