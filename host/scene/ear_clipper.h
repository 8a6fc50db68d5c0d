#pragma once
/// Ear clipping in the plane, for PolygonCutter.

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace clrender {

/// Cuts a polygon that runs counterclockwise, with coordinates of about 1 in size, into triangles
/// that do so too. Corners nearer to a line than `tolerance` count as on it. Returns false if edges
/// cross, if no ear is found, or if it takes more steps than a multiple of the number of corners.
bool clip_ears(const std::vector<glm::dvec2> &corners, double tolerance,
               std::vector<std::array<std::uint32_t, 3>> &triangles);

} // namespace clrender
