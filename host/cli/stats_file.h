#pragma once
/// What a run has done, for people and as JSON.

#include "render/render.h"

#include <string>
#include <vector>

namespace clrender::cli {

/// Seconds that render_scene() does not see.
struct RunTimes {
    double parse = 0, write = 0, total = 0;
};

/// Writes the statistics as JSON. Throws OutputError.
void write_stats(const std::string &path, const RenderResult &result, const RunTimes &times);

/// One line for the terminal.
std::string summary(const RenderResult &result, const RunTimes &times,
                    const std::vector<std::string> &outputs);

/// Why a render that could end by several rules has ended, as a line for the terminal.
std::string reason_line(const RenderResult &result, const RunTimes &times);

} // namespace clrender::cli
