#pragma once
/// Huge triangles as meshes of smaller ones, so that the rounding of their corners to float32 moves
/// no surface near the origin.

#include "real.h"

#include <array>
#include <glm/glm.hpp>
#include <vector>

namespace clrender::inline CLR_PRECISION {

/// A place on a triangle, in the renderer's coordinates and as weights of its corners.
struct SplitVertex {
    glm::dvec3 position{0.0};
    glm::dvec3 weights{0.0};
};
using SplitTriangle = std::array<SplitVertex, 3>;

/// Whether an edge is so long that the triangle may have to be split.
bool wants_split(const std::array<Vec3, 3> &corners);

/// The triangle itself, or the smaller ones that cover it, with its orientation. An edge is cut at
/// places that depend on its two ends alone, so triangles that share one stay joined.
std::vector<SplitTriangle> split_triangle(const std::array<glm::dvec3, 3> &corners);

} // namespace clrender::inline CLR_PRECISION
