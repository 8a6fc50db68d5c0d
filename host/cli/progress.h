#pragma once
/// How far a render has come, on stderr: a bar on a terminal, else a line now and then.

#include <chrono>
#include <string>

namespace clrender::cli {

/// Not thread-safe: one thread reports.
class Progress {
public:
    /// A render of `total_paths` paths, `spp` of them for each pixel. Prints nothing unless
    /// `enabled`.
    Progress(double total_paths, int spp, bool enabled);
    ~Progress() { finish(); }
    Progress(const Progress &) = delete;
    Progress &operator=(const Progress &) = delete;

    /// `paths_done` paths of all are finished. Cheap: draws a few times a second at most.
    void update(double paths_done);

    /// Removes the bar, so that what is printed next stands on a line of its own.
    void finish();

private:
    using Clock = std::chrono::steady_clock;

    [[nodiscard]] std::string describe(double paths_done, double seconds) const;

    double total_paths_;
    int spp_;
    bool enabled_;
    bool terminal_;
    bool drawn_ = false; ///< the terminal's current line holds the bar
    Clock::time_point start_;
    Clock::time_point last_;
};

/// `seconds` as people say it: "8 s", "2 m 05 s", "3 h 20 m".
std::string format_duration(double seconds);

} // namespace clrender::cli
