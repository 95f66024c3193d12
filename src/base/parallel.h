#pragma once
// Loops over all cores. One thin layer over oneTBB so that the rest of the code names no thread library.

#include <cstddef>
#include <functional>

namespace pentaprism {

/// Processors in use: what set_thread_count() said, else PENTAPRISM_THREADS, else all. Never below 1.
int thread_count();

/// For the whole process; 0: back to the default.
void set_thread_count(int threads);

/// Calls body(i) for each i in [0, n), in any order, from up to thread_count() threads; returns when all are done. The
/// first exception thrown by a body is thrown again here. Nothing about results may depend on who ran what.
void parallel_for(std::size_t n, const std::function<void(std::size_t)>& body);

/// The same over ranges [begin, end) of at most `grain` indices, in any order.
void parallel_ranges(std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

/// Calls body(). While its loops wait for other threads, this thread takes up nothing from outside them: so inside a
/// loop's body, body() may be called with a lock held.
void isolated(const std::function<void()>& body);

/// Waits until the threads of all loops have ended; a later loop starts new ones. For the end of the process, where
/// libraries tidy up what such threads still hold. Not from within a loop.
void end_threads();

}  // namespace pentaprism
