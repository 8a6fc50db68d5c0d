#include "shape_bounds.h"

#include <cmath>
#include <tbb/parallel_for.h>

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
    case ShapeKind::rectangle:
    case ShapeKind::disk:
    case ShapeKind::mesh:
        break;
    }
    return box_range(box, origin, axis);
}

} // namespace clrender
