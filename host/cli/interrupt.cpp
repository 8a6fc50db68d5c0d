#include "cli/interrupt.h"

#include <atomic>
#include <csignal>
#include <string_view>
#include <unistd.h>

namespace clrender::cli {

namespace {

std::atomic<bool> keeping{false};
std::atomic<int> received{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler may only touch such");

/// Only what a signal handler may call: no streams, no exit handlers, no destructors.
[[noreturn]] void end_at_once(int signal, std::string_view why) {
    (void)!write(STDERR_FILENO, why.data(), why.size());
    _exit(128 + signal);
}

extern "C" void on_signal(int signal) {
    if (!keeping)
        end_at_once(signal,
                    "clrender: interrupted before the first samples, no picture is written\n");
    if (received.exchange(signal) != 0)
        end_at_once(signal,
                    "\nclrender: interrupted again, ended before the pictures are written\n");
}

} // namespace

void catch_interrupts() {
    // SA_RESTART: reads and writes under way go on as if nothing had happened.
    struct sigaction action = {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

void keep_picture() {
    keeping = true;
}

int interrupted() {
    return received;
}

void ignore_write_signals() {
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
}

} // namespace clrender::cli
