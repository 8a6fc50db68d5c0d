#include "cli/interrupt.h"

#include <atomic>
#include <csignal>

namespace clrender::cli {

namespace {

std::atomic<bool> flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch such");

extern "C" void on_signal(int) {
    flag = true;
}

} // namespace

void catch_interrupts() {
    // SA_RESETHAND: the second signal finds the default action, which ends the process.
    // SA_RESTART: reads and writes under way go on as if nothing had happened.
    struct sigaction action = {};
    action.sa_handler = on_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

void ignore_write_signals() {
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
}

bool interrupted() {
    return flag;
}

} // namespace clrender::cli
