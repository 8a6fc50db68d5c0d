#pragma once
/// The cube as a mesh.

#include "scene.h"

#include <memory>

namespace clrender {

/// The cube [-1,1]^3 with the vertices, normals (outwards) and texture coordinates (each face is
/// [0,1]^2) of Mitsuba's `cube`. Always the same object.
std::shared_ptr<const Mesh> cube_mesh();

} // namespace clrender
