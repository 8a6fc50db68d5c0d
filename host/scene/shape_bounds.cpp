#include "shape_bounds.h"

#include <cmath>
#include <tbb/parallel_for.h>

namespace clrender {

double sphere_radius(const Shape &shape) {
    return std::cbrt(std::abs(glm::determinant(glm::dmat3(shape.to_world))));
}

double largest_stretch(const glm::dmat3 &matrix) {
    // Power iteration with the squares of the matrix, from the longest column.
    glm::dvec3 v = matrix[0];
    for (const int i : {1, 2})
        if (glm::length(matrix[i]) > glm::length(v))
            v = matrix[i];
    double stretch = 0;
    constexpr int steps = 64;
    for (int i = 0; i < steps && glm::length(v) > 0; ++i) {
        v = matrix * (glm::normalize(v) * matrix);
        stretch = std::sqrt(glm::length(v));
    }
    return stretch;
}

bool is_nearly_singular(const glm::dmat3 &to_world) {
    constexpr double most = 1e8;
    return !(largest_stretch(to_world) * largest_stretch(glm::inverse(to_world)) <= most);
}

namespace {

/// How far an ellipsoid or a cylinder reaches from its middle along `axis`.
double reach_along(const Shape &shape, const glm::dvec3 &axis) {
    const glm::dvec3 along = axis * glm::dmat3(shape.to_world);
    return shape.kind == ShapeKind::cylinder ? std::hypot(along.x, along.y) + std::abs(along.z) / 2
                                             : glm::length(along);
}

/// The middle of an ellipsoid or a cylinder.
glm::dvec3 middle_of(const Shape &shape) {
    const double height = shape.kind == ShapeKind::cylinder ? 0.5 : 0;
    return glm::dvec3(shape.to_world * glm::dvec4(0, 0, height, 1));
}

} // namespace

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
    case ShapeKind::ellipsoid:
    case ShapeKind::cylinder: {
        const glm::dvec3 half(reach_along(shape, {1, 0, 0}), reach_along(shape, {0, 1, 0}),
                              reach_along(shape, {0, 0, 1}));
        box.add(middle_of(shape) - half);
        box.add(middle_of(shape) + half);
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

Box group_box(const ShapeGroup &group) {
    Box box;
    for (const Shape &shape : group.shapes)
        box.add(shape_box(shape));
    return box;
}

Box placed_box(const ShapeInstance &instance, const Box &group) {
    Box box;
    if (group.empty())
        return box;
    for (const glm::dvec3 &corner : group.corners())
        box.add(instance.to_world * glm::dvec4(corner, 1));
    return box;
}

std::vector<Box> instance_boxes(const Scene &scene) {
    std::vector<Box> groups;
    for (const ShapeGroup &group : scene.groups)
        groups.push_back(group_box(group));
    std::vector<Box> boxes(scene.instances.size());
    tbb::parallel_for(std::size_t(0), boxes.size(), [&](std::size_t i) {
        const ShapeInstance &instance = scene.instances[i];
        boxes[i] = placed_box(instance, groups[static_cast<std::size_t>(instance.group)]);
    });
    return boxes;
}

Range box_range(const Box &box, const glm::dvec3 &origin, const glm::dvec3 &axis) {
    Range range;
    if (!box.empty())
        for (const glm::dvec3 &corner : box.corners())
            range.add(glm::dot(corner - origin, axis));
    return range;
}

Range shape_range(const Shape &shape, const Box &box, const glm::dvec3 &origin,
                  const glm::dvec3 &axis) {
    switch (shape.kind) {
    case ShapeKind::sphere: {
        const double middle = glm::dot(glm::dvec3(shape.to_world[3]) - origin, axis);
        return {middle - sphere_radius(shape), middle + sphere_radius(shape)};
    }
    case ShapeKind::ellipsoid:
    case ShapeKind::cylinder: {
        const double middle = glm::dot(middle_of(shape) - origin, axis);
        return {middle - reach_along(shape, axis), middle + reach_along(shape, axis)};
    }
    case ShapeKind::rectangle:
    case ShapeKind::disk:
    case ShapeKind::mesh:
        break;
    }
    return box_range(box, origin, axis);
}

} // namespace clrender
