#pragma once
/// Which options exclude one another.

#include "cli/options.h"

#include <optional>
#include <string>
#include <vector>

namespace clrender::cli {

/// What the options of when a render ends, of checkpoints and of parts may not say together, or
/// nothing. `with_profile`: --profile is among them.
std::optional<std::string> conflict_of_ends(const Options &options, bool with_profile);

/// Why an option that was given has no meaning for `merge`, which only adds up and writes.
std::optional<std::string> conflict_of_merge(const CLI::App &app);

/// What is to be written to one file twice.
std::optional<std::string> conflict_of_files(const std::vector<std::string> &files);

} // namespace clrender::cli
