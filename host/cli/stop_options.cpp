#include "stop_options.h"

#include "option_values.h"

#include <charconv>
#include <cmath>
#include <string_view>

namespace clrender::cli {

namespace {

constexpr const char *group = "When it is done (the first that is reached)";

/// Reads a number at the beginning of `text`, and takes it away.
std::optional<double> take_number(std::string_view &text) {
    double value = 0;
    const auto [stop, error] =
        std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
    if (error != std::errc() || !std::isfinite(value) || value < 0)
        return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
    return value;
}

} // namespace

std::optional<double> parse_duration(const std::string &text) {
    constexpr std::string_view units = "hms";
    constexpr double unit_seconds[] = {3600, 60, 1};
    constexpr double least = 1e-3, most = 1e8;
    std::string_view rest = text;
    std::size_t next_unit = 0;
    double seconds = 0;
    while (!rest.empty()) {
        const auto value = take_number(rest);
        if (!value)
            return std::nullopt;
        // A number without a unit stands alone.
        const std::size_t unit = rest.empty() ? 2 : units.find(rest.front(), next_unit);
        if (unit == std::string_view::npos || (rest.empty() && next_unit > 0))
            return std::nullopt;
        seconds += *value * unit_seconds[unit];
        next_unit = unit + 1;
        rest.remove_prefix(rest.empty() ? 0 : 1);
    }
    return seconds >= least && seconds <= most ? std::optional(seconds) : std::nullopt;
}

std::optional<double> parse_share(const std::string &text) {
    std::string_view rest = text;
    const auto value = take_number(rest);
    if (!value || !(rest.empty() || rest == "%"))
        return std::nullopt;
    const double share = *value / (rest.empty() ? 1 : 100);
    return share > 0 && share <= 1 ? std::optional(share) : std::nullopt;
}

void add_stop_options(CLI::App &app, StopOptions &options) {
    app.add_option_function<std::string>(
           "--time", [&](const std::string &text) { options.seconds = parse_duration(text); },
           "Until the picture is written: 90s, 5m, 2h, 1h30m")
        ->type_name("T")
        ->check(parsed_by(parse_duration, "is not a time such as 90s, 5m or 1h30m"))
        ->group(group);
    app.add_option_function<std::string>(
           "--target-error", [&](const std::string &text) { options.error = parse_share(text); },
           "Relative error of the picture, such as 1% or 0.01: the square root of\n"
           "the mean of variance / (value^2 + .01) over pixels and colours")
        ->type_name("E")
        ->check(parsed_by(parse_share, "is not an error such as 1% or 0.01"))
        ->group(group);
}

} // namespace clrender::cli
