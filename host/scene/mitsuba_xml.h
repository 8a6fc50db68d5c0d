#pragma once
/// The reader of Mitsuba 3's scene format.

#include "load_scene.h"

namespace clrender {

/// Reads a scene file with the meaning that Mitsuba 3 gives it in RGB mode. Throws InputError, also
/// for what is not supported; warns of what is ignored.
Scene load_mitsuba_xml(const std::string &path, const LoadOptions &options);

} // namespace clrender
