#pragma once
/// Walls, floors and ceilings cast no shadows into their own room.

#include "scene/scene.h"

#include <vector>

namespace clrender {

/// Which of the scene's shapes are rectangles or disks that never come between a point of a surface
/// and a point of a light: all shapes and point lights lie in its plane or on one side of it, or it
/// is the only light itself. None is, where light comes from outside of the scene and is sampled.
[[nodiscard]] std::vector<bool> shadowless_planars(const Scene &scene);

} // namespace clrender
