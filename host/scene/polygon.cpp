#include "polygon.h"

#include "ear_clipper.h"

#include <algorithm>
#include <cmath>

namespace clrender {

namespace {

/// Twice the area, along the normal (Newell's method, about the first corner).
glm::dvec3 area_vector(std::span<const glm::dvec3> corners) {
    glm::dvec3 sum(0);
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        sum += glm::cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
    return sum;
}

/// The largest of the coordinates, and of their distances from the first corner.
struct Size {
    double place = 0, extent = 0;
};

Size size_of(std::span<const glm::dvec3> corners) {
    Size size;
    for (const glm::dvec3 &corner : corners)
        for (int axis = 0; axis < 3; ++axis) {
            size.place = std::max(size.place, std::abs(corner[axis]));
            size.extent = std::max(size.extent, std::abs(corner[axis] - corners[0][axis]));
        }
    return size;
}

/// Seen along `normal`, as a polygon in the plane that runs counterclockwise, scaled to [-1, 1].
std::vector<glm::dvec2> projected(std::span<const glm::dvec3> corners, const glm::dvec3 &normal,
                                  double extent) {
    const glm::dvec3 n = glm::normalize(normal);
    const glm::dvec3 a = glm::abs(n);
    const glm::dvec3 axis = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                            : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                     : glm::dvec3(0, 0, 1);
    const glm::dvec3 u = glm::normalize(glm::cross(axis, n));
    const glm::dvec3 v = glm::cross(n, u);
    std::vector<glm::dvec2> flat;
    flat.reserve(corners.size());
    for (const glm::dvec3 &corner : corners) {
        const glm::dvec3 p = (corner - corners[0]) / extent;
        flat.emplace_back(glm::dot(p, u), glm::dot(p, v));
    }
    return flat;
}

} // namespace

void PolygonCutter::cut_fan(std::size_t count) {
    triangles_.clear();
    for (std::uint32_t i = 1; i + 1 < count; ++i)
        triangles_.push_back({0, i, i + 1});
}

/// True if no triangle of the fan is turned over or without area, and together they go round the
/// first corner less than once.
bool PolygonCutter::is_fan_exact(std::span<const glm::dvec3> corners,
                                 const glm::dvec3 &normal) const {
    constexpr double least_sine = 1e-9;
    double angle = 0;
    for (const Triangle &t : triangles_) {
        const glm::dvec3 side1 = corners[t[1]] - corners[0];
        const glm::dvec3 side2 = corners[t[2]] - corners[0];
        const double sine = glm::dot(glm::cross(side1, side2), normal);
        if (!(sine > least_sine * glm::length(side1) * glm::length(side2)))
            return false;
        if (triangles_.size() > 2)
            angle += std::atan2(sine, glm::dot(side1, side2));
    }
    return angle < 2 * M_PI;
}

bool PolygonCutter::cut(std::span<const glm::dvec3> corners) {
    cut_fan(corners.size());
    if (corners.size() == 3)
        return true;
    const Size size = size_of(corners);
    const double extent = size.extent;
    if (!(extent > 0))
        return true;
    const glm::dvec3 normal = area_vector(corners) / (extent * extent);
    const double area = glm::length(normal);
    if (area > 0 && is_fan_exact(corners, normal / area))
        return true;

    // Coordinates that have been rounded to float32 are off by up to 2^-25 of their size; a few
    // times that, as corners are the ends of edges that may have been rotated.
    constexpr double float_error = 0x1p-22;
    const double rounding = float_error * size.place / extent;
    if (area <= rounding) {
        // Without area: a line is cut well by any fan, a figure of eight by none.
        const glm::dvec3 along = *std::max_element(
            corners.begin(), corners.end(), [&](const glm::dvec3 &a, const glm::dvec3 &b) {
                return glm::length(a - corners[0]) < glm::length(b - corners[0]);
            });
        const glm::dvec3 direction = glm::normalize(along - corners[0]);
        return std::all_of(corners.begin(), corners.end(), [&](const glm::dvec3 &corner) {
            return glm::length(glm::cross((corner - corners[0]) / extent, direction)) <=
                   std::max(rounding, 1e-12);
        });
    }

    // Exactly as the corners stand; else as they may have stood before they were rounded.
    const std::vector<glm::dvec2> flat = projected(corners, normal, extent);
    std::vector<Triangle> ears;
    for (const double tolerance : {0x1p-45, rounding})
        if (clip_ears(flat, tolerance, ears)) {
            triangles_ = std::move(ears);
            return true;
        }
    return false;
}

} // namespace clrender
