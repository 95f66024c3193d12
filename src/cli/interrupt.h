#pragma once
// SIGINT and SIGTERM stop the work at the next moment at which nothing is lost but the frame under way.

namespace pentaprism::cli {

/// The first signal is remembered; a second one of the same kind ends the program at once.
void watch_signals();

/// SIGINT or SIGTERM, or 0.
int caught_signal();

/// Throws Error(kRender) "interrupted" after a signal.
void throw_if_interrupted();

}  // namespace pentaprism::cli
