#pragma once
/// How the values of options are read and checked.

#include <CLI/CLI.hpp>

#include <charconv>
#include <cstdint>
#include <fmt/core.h>
#include <optional>
#include <string>
#include <vector>

namespace clrender::cli {

/// Reads all of `text` as a number; nothing where there is anything else in it.
template <class Number> std::optional<Number> parse_number(const std::string &text) {
    Number value{};
    const char *end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stop != end)
        return std::nullopt;
    return value;
}

/// A check for CLI11: a whole number from `low` to `high`.
CLI::Validator whole_number(std::int64_t low, std::int64_t high);

/// A check for CLI11: a finite number from `low` to `high`.
CLI::Validator number(double low, double high);

/// A check for CLI11: one of `words`.
CLI::Validator one_of(const std::vector<std::string> &words);

/// A check for CLI11: the word auto, or what another check accepts.
CLI::Validator auto_or(const CLI::Validator &other);

/// A check for CLI11: some text.
CLI::Validator not_empty();

/// A check for CLI11: what `parse`, which returns an optional, makes a value of; other text `is`
/// something else, as in "is not a size such as 4G".
template <class Parse> CLI::Validator parsed_by(Parse parse, const std::string &is) {
    return {[=](std::string &text) {
                return parse(text) ? std::string() : fmt::format("'{}' {}", text, is);
            },
            ""};
}

/// Bytes, or with K, M, G or T behind the number times 1024, 1024^2 and so on, as in 512M, 1.5GiB.
std::optional<std::uint64_t> parse_size(const std::string &text);

} // namespace clrender::cli
