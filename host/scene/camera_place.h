#pragma once
/// Where the camera is among the shapes.

#include "scene.h"

namespace clrender {

/// Warns if the camera is inside a sphere or a closed mesh whose inner side is black or glass.
void warn_of_enclosed_camera(const Scene &scene);

} // namespace clrender
