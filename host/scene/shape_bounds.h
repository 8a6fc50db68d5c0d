#pragma once
/// The extent of shapes in world coordinates, in double precision.

#include "scene.h"

#include <limits>

namespace clrender {

struct Box {
    glm::dvec3 low{std::numeric_limits<double>::infinity()};
    glm::dvec3 high{-std::numeric_limits<double>::infinity()};

    void add(const glm::dvec3 &p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    [[nodiscard]] bool empty() const { return !(low.x <= high.x); }
};

/// The box of a shape; of a disk that of the rectangle around it.
Box shape_box(const Shape &shape);

/// Radius of a sphere: the cube root of the volume that to_world gives a unit cube.
double sphere_radius(const Shape &shape);

} // namespace clrender
