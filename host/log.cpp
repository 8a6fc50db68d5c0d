#include "log.h"

#include <atomic>
#include <cstdio>
#include <fmt/core.h>

namespace clrender::log {

namespace {
std::atomic<Level> current_level{Level::normal};
} // namespace

void set_level(Level level) {
    current_level = level;
}

void warn(const SourceLocation &where, const std::string &text) {
    fmt::print(stderr, "{}: warning: {}\n", where.str(), text);
}

void warn(const std::string &text) {
    fmt::print(stderr, "clrender: warning: {}\n", text);
}

void info(const std::string &text) {
    if (current_level != Level::quiet)
        fmt::print(stderr, "{}\n", text);
}

void detail(const std::string &text) {
    if (current_level == Level::verbose)
        fmt::print(stderr, "{}\n", text);
}

} // namespace clrender::log
