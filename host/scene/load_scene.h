#pragma once
/// The one entry to all readers.

#include "scene.h"

#include <map>
#include <optional>
#include <string>

namespace clrender {

/// What the command line may change while a scene is read.
struct LoadOptions {
    std::map<std::string, std::string> defines; ///< -D name=value
    std::optional<int> sensor{}; ///< of several, counted from 0; unless stated the first one
    bool all_faults = false; ///< goes on behind the first fault of a scene, and throws all in one
};

/// Reads a Mitsuba XML scene, or a bare .gltf / .glb / .obj / .ply model (given a framing
/// camera and a soft light where it has none). Throws InputError. Warns of every -D that nothing
/// uses and of all that is ignored.
Scene load_scene(const std::string &path, const LoadOptions &options = {});

} // namespace clrender
