#pragma once
/// glTF models.

#include "load_scene.h"
#include "scene.h"

#include <string>

namespace clrender {

/// Reads a .gltf or .glb file (glTF 2.0). Its cameras are the sensors, in the order of the nodes;
/// without one a camera frames the model. Where nothing shines there are the light and the sky
/// that bare models have, and without a camera their ground too. Warns of what is ignored. Throws
/// InputError.
Scene load_gltf(const std::string &path, const LoadOptions &options);

} // namespace clrender
