#include "log.h"

#include <atomic>
#include <cstdio>
#include <fmt/core.h>
#include <utility>

namespace clrender::log {

namespace {

std::atomic<Level> current_level{Level::normal};
/// Where the messages of this thread go, if not to the terminal.
thread_local std::string *holder = nullptr;

void show(const std::string &line) {
    if (holder != nullptr)
        *holder += line;
    else
        raw(line);
}

} // namespace

void set_level(Level level) {
    current_level = level;
}

void warn(const SourceLocation &where, const std::string &text) {
    show(fmt::format("{}: warning: {}\n", where.str(), text));
}

void warn(const std::string &text) {
    show(fmt::format("clrender: warning: {}\n", text));
}

void error(const std::string &text) {
    show("clrender: " + text + "\n");
}

void raw(const std::string &text) {
    // Not fmt::print, which throws where stderr is closed or its disk is full.
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

void info(const std::string &text) {
    if (current_level != Level::quiet)
        show(text + "\n");
}

void detail(const std::string &text) {
    if (current_level == Level::verbose)
        show(text + "\n");
}

Holder::Holder() : outer_(std::exchange(holder, &kept_)) {}

Holder::~Holder() {
    holder = outer_;
}

std::string Holder::take() {
    return std::exchange(kept_, {});
}

void pass_on(const std::string &kept) {
    if (!kept.empty())
        show(kept);
}

} // namespace clrender::log
