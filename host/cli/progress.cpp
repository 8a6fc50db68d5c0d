#include "cli/progress.h"

#include "log.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fmt/core.h>
#include <unistd.h>

namespace clrender::cli {

namespace {

constexpr double bar_interval = 0.1; // seconds between two drawings of the bar
constexpr double line_interval = 10; // seconds between two lines where there is no terminal
constexpr int bar_width = 24;

double seconds_between(std::chrono::steady_clock::time_point from,
                       std::chrono::steady_clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
}

} // namespace

std::string format_duration(double seconds) {
    const auto whole = static_cast<long long>(std::ceil(std::clamp(seconds, 0.0, 1e9)));
    if (whole < 60)
        return fmt::format("{} s", whole);
    if (whole < 3600)
        return fmt::format("{} m {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} m", whole / 3600, whole % 3600 / 60);
}

Progress::Progress(double total_paths, int spp, bool enabled)
    : total_paths_(std::max(total_paths, 1.0)), spp_(spp), enabled_(enabled),
      terminal_(isatty(STDERR_FILENO) == 1), start_(Clock::now()), last_(start_) {}

void Progress::update(double paths_done) {
    if (!enabled_)
        return;
    const Clock::time_point now = Clock::now();
    if (seconds_between(last_, now) < (terminal_ ? bar_interval : line_interval))
        return;
    last_ = now;
    const std::string text = describe(paths_done, seconds_between(start_, now));

    // A terminal's line is drawn over in place: \r goes to its start, \033[K clears what was
    // longer.
    if (terminal_) {
        const int filled = static_cast<int>(bar_width * std::min(paths_done / total_paths_, 1.0));
        log::raw(
            fmt::format("\r[{:#<{}}{:.<{}}] {}\033[K", "", filled, "", bar_width - filled, text));
        drawn_ = true;
    } else {
        log::raw(text + "\n");
    }
}

std::string Progress::describe(double paths_done, double seconds) const {
    const double fraction = std::min(paths_done / total_paths_, 1.0);
    const double rate = paths_done / seconds;
    std::string text =
        fmt::format("{:3.0f}%  {:.0f} of {} samples  {:.2f} Mpaths/s", std::floor(100 * fraction),
                    std::floor(spp_ * fraction), spp_, rate * 1e-6);
    if (rate > 0)
        text += "  " + format_duration((total_paths_ - paths_done) / rate) + " left";
    return text;
}

void Progress::finish() {
    if (drawn_) {
        log::raw("\r\033[K");
    }
    drawn_ = false;
}

} // namespace clrender::cli
