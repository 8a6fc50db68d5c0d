#pragma once
/// How far a render has come, on stderr: a bar on a terminal, else a line now and then.

#include "render/render_progress.h"

#include <chrono>
#include <string>

namespace clrender::cli {

/// Not thread-safe: one thread reports.
class Progress {
public:
    /// Prints nothing unless `enabled`.
    explicit Progress(bool enabled);
    ~Progress() { finish(); }
    Progress(const Progress &) = delete;
    Progress &operator=(const Progress &) = delete;

    /// Cheap: draws a few times a second at most.
    void update(const RenderProgress &progress);

    /// Removes the bar, so that what is printed next stands on a line of its own.
    void finish();

private:
    using Clock = std::chrono::steady_clock;

    bool enabled_;
    bool terminal_;
    bool drawn_ = false; ///< the terminal's current line holds the bar
    Clock::time_point start_;
    Clock::time_point last_;
};

/// What a progress line says of a render that began `seconds` ago.
std::string describe_progress(const RenderProgress &progress, double seconds);

/// `seconds` as people say it: "8 s", "2 m 05 s", "3 h 20 m".
std::string format_duration(double seconds);

} // namespace clrender::cli
