#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace pentaprism {
namespace {

std::atomic<int> requested_threads{0};
std::mutex limit_mutex;
std::unique_ptr<tbb::global_control> limit;
int limit_in_force = 0;

int default_thread_count() {
    if (const char* text = std::getenv("PENTAPRISM_THREADS")) {
        const int threads = std::atoi(text);
        if (threads > 0) return threads;
    }
    return std::max(1, tbb::info::default_concurrency());
}

void apply_limit() {
    const int wanted = thread_count();
    const std::lock_guard<std::mutex> lock(limit_mutex);
    if (wanted == limit_in_force) return;
    limit.reset();
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, wanted);
    limit_in_force = wanted;
}

}  // namespace

int thread_count() {
    const int requested = requested_threads.load();
    return requested > 0 ? requested : default_thread_count();
}

void set_thread_count(int threads) {
    requested_threads.store(std::max(0, threads));
}

void parallel_for(std::size_t n, const std::function<void(std::size_t)>& body) {
    parallel_ranges(n, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) body(i);
    });
}

void parallel_ranges(std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
    if (n == 0) return;
    apply_limit();
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, n, std::max<std::size_t>(1, grain)),
        [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); },
        tbb::simple_partitioner());
}

void isolated(const std::function<void()>& body) {
    tbb::this_task_arena::isolate(body);
}

void end_threads() {
    tbb::task_scheduler_handle handle{tbb::attach{}};
    tbb::finalize(handle, std::nothrow);
}

}  // namespace pentaprism
