#include "cli/option_values.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace clrender::cli {

CLI::Validator whole_number(std::int64_t low, std::int64_t high) {
    return {[=](std::string &text) {
                const auto value = parse_number<std::int64_t>(text);
                if (value && *value >= low && *value <= high)
                    return std::string();
                return fmt::format("'{}' is not a whole number from {} to {}", text, low, high);
            },
            ""};
}

CLI::Validator number(double low, double high) {
    return {[=](std::string &text) {
                const auto value = parse_number<double>(text);
                if (value && std::isfinite(*value) && *value >= low && *value <= high)
                    return std::string();
                return fmt::format("'{}' is not a number from {} to {}", text, low, high);
            },
            ""};
}

CLI::Validator one_of(const std::vector<std::string> &words) {
    return {[=](std::string &text) {
                if (std::find(words.begin(), words.end(), text) != words.end())
                    return std::string();
                return fmt::format("'{}' is not {}", text, CLI::detail::join(words, ", "));
            },
            ""};
}

CLI::Validator auto_or(const CLI::Validator &other) {
    return {[other](std::string &text) {
                std::string fault = text == "auto" ? "" : other(text);
                return fault.empty() ? fault : fault + ", or auto";
            },
            ""};
}

std::optional<std::uint64_t> parse_size(const std::string &text) {
    constexpr std::string_view units = "KMGT";
    const std::size_t end = std::min(text.find_first_not_of("0123456789."), text.size());
    const auto value = parse_number<double>(text.substr(0, end));
    std::string unit = text.substr(end);
    std::size_t power = 0;
    if (!unit.empty() && units.find(unit[0]) != std::string_view::npos)
        power = units.find(unit[0]) + 1;
    const std::string behind = unit.substr(power > 0 ? 1 : 0);
    if (!value || !(behind.empty() || behind == "B" || (power > 0 && behind == "iB")))
        return std::nullopt;
    const double bytes = std::ldexp(*value, 10 * static_cast<int>(power));
    constexpr double most = 9e18;
    if (!(bytes >= 1 && bytes <= most))
        return std::nullopt;
    return static_cast<std::uint64_t>(bytes);
}

CLI::Validator not_empty() {
    return {[](std::string &text) { return text.empty() ? "is empty" : ""; }, ""};
}

} // namespace clrender::cli
