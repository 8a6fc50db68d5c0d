#pragma once
/// What commands print to stdout.

#include <cstdio>
#include <fmt/format.h>
#include <utility>

namespace clrender {

/// A failed write shows at the end of the run, in main(); fmt::print would throw.
template <typename... Values> void print(fmt::format_string<Values...> format, Values &&...values) {
    const std::string text = fmt::format(format, std::forward<Values>(values)...);
    std::fwrite(text.data(), 1, text.size(), stdout);
}

} // namespace clrender
