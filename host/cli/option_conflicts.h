#pragma once
/// Which options exclude one another.

#include "cli/options.h"

#include <optional>
#include <string>

namespace clrender::cli {

/// What the options of when a render ends, of checkpoints and of parts may not say together, or
/// nothing. `with_profile`: --profile is among them.
std::optional<std::string> conflict_of_ends(const Options &options, bool with_profile);

} // namespace clrender::cli
