#include "shape_bounds.h"

#include <cmath>

namespace clrender {

double sphere_radius(const Shape &shape) {
    return std::cbrt(std::abs(glm::determinant(glm::dmat3(shape.to_world))));
}

Box shape_box(const Shape &shape) {
    Box box;
    const auto add = [&](const glm::dvec3 &p) {
        box.add(glm::dvec3(shape.to_world * glm::dvec4(p, 1)));
    };
    switch (shape.kind) {
    case ShapeKind::sphere: {
        const glm::dvec3 center(shape.to_world[3]);
        box.add(center - sphere_radius(shape));
        box.add(center + sphere_radius(shape));
        break;
    }
    case ShapeKind::rectangle:
    case ShapeKind::disk:
        for (const double x : {-1.0, 1.0})
            for (const double y : {-1.0, 1.0})
                add({x, y, 0});
        break;
    case ShapeKind::mesh:
        for (const glm::dvec3 &p : shape.mesh->positions)
            add(p);
        break;
    }
    return box;
}

Range shape_range(const Shape &shape, const Box &box, const glm::dvec3 &origin,
                  const glm::dvec3 &axis) {
    switch (shape.kind) {
    case ShapeKind::sphere: {
        const double middle = glm::dot(glm::dvec3(shape.to_world[3]) - origin, axis);
        return {middle - sphere_radius(shape), middle + sphere_radius(shape)};
    }
    case ShapeKind::rectangle:
    case ShapeKind::disk:
    case ShapeKind::mesh:
        break;
    }
    Range range;
    if (!box.empty())
        for (const glm::dvec3 &corner : box.corners())
            range.add(glm::dot(corner - origin, axis));
    return range;
}

} // namespace clrender
