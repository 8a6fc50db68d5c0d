#pragma once
/// A picture of a bare model: what the file lacks to be a scene.

#include "scene.h"

#include <string>

namespace clrender {

/// Reads PATH (.obj or .ply) and puts it on a grey ground, under a large soft light above to the
/// left and a dim sky, before a camera that frames it from above its right front. The y axis
/// points up. Materials come from the OBJ's MTL files: Kd and map_Kd diffuse, Ke an area light,
/// mirrors (illum 5, or Ks without Kd) and glass (illum 4, 6, 7, 9, or d < 1, with Ni). Throws
/// InputError.
Scene load_model(const std::string &path);

} // namespace clrender
