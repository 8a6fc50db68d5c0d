#pragma once
/// What Mitsuba has, or its forks, that is not built.

#include <string>

namespace clrender::mitsuba {

/// The nearest thing that is supported, in words for a message, to an object of this tag and type;
/// "" if nothing is known of it.
std::string nearest_supported(const std::string &tag, const std::string &type);

} // namespace clrender::mitsuba
