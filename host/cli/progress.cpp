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

std::string describe_progress(const RenderProgress &progress, double seconds) {
    // A render that ends by another rule has no number to go to.
    const double shown =
        progress.most_samples > 0 ? std::floor(progress.samples) : std::ceil(progress.samples);
    std::string text = std::isnan(progress.fraction)
                           ? std::string("     ")
                           : fmt::format("{:3.0f}%  ", std::floor(100 * progress.fraction));
    text += fmt::format("{:.0f}", shown);
    if (progress.most_samples > 0)
        text += fmt::format(" of {}", progress.most_samples);
    text += " samples";
    if (std::isfinite(progress.error))
        text += fmt::format("  error {:.2g}%", 100 * progress.error);
    text += fmt::format("  {:.2f} Mpaths/s", progress.paths / seconds * 1e-6);
    if (std::isfinite(progress.seconds_left))
        text += "  " + format_duration(progress.seconds_left) + " left";
    return text;
}

Progress::Progress(bool enabled)
    : enabled_(enabled), terminal_(isatty(STDERR_FILENO) == 1), start_(Clock::now()),
      last_(start_) {}

void Progress::update(const RenderProgress &progress) {
    if (!enabled_)
        return;
    const Clock::time_point now = Clock::now();
    if (seconds_between(last_, now) < (terminal_ ? bar_interval : line_interval))
        return;
    last_ = now;
    const std::string text = describe_progress(progress, seconds_between(start_, now));

    // A terminal's line is drawn over in place: \r goes to its start, \033[K clears what was
    // longer.
    if (terminal_) {
        const double fraction = std::isnan(progress.fraction) ? 0 : progress.fraction;
        const int filled = static_cast<int>(bar_width * std::clamp(fraction, 0.0, 1.0));
        log::raw(
            fmt::format("\r[{:#<{}}{:.<{}}] {}\033[K", "", filled, "", bar_width - filled, text));
        drawn_ = true;
    } else {
        log::raw(text + "\n");
    }
}

void Progress::finish() {
    if (drawn_) {
        log::raw("\r\033[K");
    }
    drawn_ = false;
}

} // namespace clrender::cli
