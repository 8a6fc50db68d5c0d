#pragma once
/// What the command line says of when a render is done: --time and --target-error.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

namespace clrender::cli {

struct StopOptions {
    std::optional<double> seconds; ///< --time: from the start of the program to the written picture
    std::optional<double> error;   ///< --target-error: relative, 1% being .01

    [[nodiscard]] bool any() const { return seconds || error; }
};

/// "90s", "5m", "2h", "1h30m", or seconds without a unit, as seconds; nothing where it is none.
std::optional<double> parse_duration(const std::string &text);

/// A number, or per cent with % behind it, above 0 and at most 1.
std::optional<double> parse_share(const std::string &text);

/// Adds the options to those of a render.
void add_stop_options(CLI::App &app, StopOptions &options);

} // namespace clrender::cli
