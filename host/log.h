#pragma once
/// Messages for the person at the terminal, all on stderr. Thread-safe. A message that cannot be
/// written is lost, and no more than that.

#include "error.h"

#include <string>

namespace clrender::log {

enum class Level { quiet, normal, verbose };

/// `quiet` keeps warnings; `verbose` adds `detail` lines. Default: normal.
void set_level(Level level);

/// `file:line: warning: text`, shown at every level.
void warn(const SourceLocation &where, const std::string &text);
void warn(const std::string &text);
/// `clrender: text`, shown at every level.
void error(const std::string &text);
/// `text` as it is, shown at every level and never held: what a terminal's progress bar is made of.
void raw(const std::string &text);
/// One line of progress or outcome; hidden by `quiet`.
void info(const std::string &text);
/// Shown only when `verbose`.
void detail(const std::string &text);

/// While it lives, the messages of the thread that has made it are kept. Others are not.
class Holder {
public:
    Holder();
    ~Holder();
    Holder(const Holder &) = delete;
    Holder &operator=(const Holder &) = delete;

    /// What has been kept so far, for `pass_on`.
    std::string take();

private:
    std::string kept_;
    std::string *outer_;
};

/// Shows what a holder has kept.
void pass_on(const std::string &kept);

} // namespace clrender::log
