#include "cli/interrupt.h"

#include <csignal>
#include <pentaprism/error.h>

namespace pentaprism::cli {
namespace {

volatile std::sig_atomic_t signal_number = 0;

extern "C" void remember(int number) {
    signal_number = number;
}

}  // namespace

void watch_signals() {
    for (const int number : {SIGINT, SIGTERM}) {
        struct sigaction action {};
        action.sa_handler = remember;
        sigemptyset(&action.sa_mask);
        action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
        sigaction(number, &action, nullptr);
    }
    // A file-size limit (ulimit -f) shall be an error of the write, with its message, and not a death.
    std::signal(SIGXFSZ, SIG_IGN);
}

int caught_signal() {
    return signal_number;
}

void throw_if_interrupted() {
    if (signal_number != 0) throw Error(ErrorKind::kRender, "interrupted");
}

}  // namespace pentaprism::cli
