#pragma once
/// Messages for the person at the terminal, all on stderr. Thread-safe.

#include "error.h"

#include <string>

namespace clrender::log {

enum class Level { quiet, normal, verbose };

/// `quiet` keeps warnings; `verbose` adds `detail` lines. Default: normal.
void set_level(Level level);

/// `file:line: warning: text`, shown at every level.
void warn(const SourceLocation &where, const std::string &text);
void warn(const std::string &text);
/// One line of progress or outcome; hidden by `quiet`.
void info(const std::string &text);
/// Shown only when `verbose`.
void detail(const std::string &text);

} // namespace clrender::log
