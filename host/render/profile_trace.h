#pragma once
/// A profile as a trace.

#include "profile.h"

#include <string>

namespace clrender {

/// Writes Chrome's trace-event format, which Perfetto opens: the host's phases on one track, the
/// device's commands on another, the counts of each pass as counters. Throws OutputError.
void write_profile_trace(const std::string &path, const Profile &profile);

} // namespace clrender
