#include "flatten_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clrender::inline CLR_PRECISION {

namespace {

struct Box {
    glm::dvec3 low{std::numeric_limits<double>::infinity()};
    glm::dvec3 high{-std::numeric_limits<double>::infinity()};

    void add(const glm::dvec3 &p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    [[nodiscard]] bool empty() const { return !(low.x <= high.x); }
    [[nodiscard]] double distance(const glm::dvec3 &p) const {
        return glm::length(glm::max(glm::max(low - p, p - high), glm::dvec3(0)));
    }
};

/// The box of a shape in world coordinates; of a sphere exactly, of the others by their corners.
Box shape_box(const Shape &shape) {
    Box box;
    const auto add = [&](double x, double y, double z) {
        box.add(glm::dvec3(shape.to_world * glm::dvec4(x, y, z, 1)));
    };
    if (shape.kind == ShapeKind::mesh) {
        for (const glm::dvec3 &p : shape.mesh->positions)
            add(p.x, p.y, p.z);
        return box;
    }
    const double depth = shape.kind == ShapeKind::sphere ? 1 : 0;
    for (int corner = 0; corner < 8; ++corner)
        add((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
            (corner & 4) != 0 ? depth : -depth);
    return box;
}

} // namespace

Placement choose_placement(const Scene &scene) {
    const glm::dvec3 eye(scene.sensor.to_world[3]);
    std::vector<Box> boxes;
    for (const Shape &shape : scene.shapes)
        boxes.push_back(shape_box(shape));
    for (const Emitter &emitter : scene.emitters)
        if (emitter.kind == EmitterKind::point)
            boxes.emplace_back().add(emitter.position);

    // Precision is wanted where the camera looks at things from near: parts of huge shapes (a
    // planet as the ground) that are farther away than every shape's nearest point do not count.
    double reach = 0;
    for (const Box &box : boxes)
        if (!box.empty())
            reach = std::max(reach, box.distance(eye));
    if (reach == 0)
        for (const Box &box : boxes)
            if (!box.empty())
                reach = std::max(reach, glm::length(box.high - box.low));
    Box all;
    all.add(eye);
    for (const Box &box : boxes)
        if (!box.empty()) {
            all.add(glm::clamp(box.low, eye - 2 * reach, eye + 2 * reach));
            all.add(glm::clamp(box.high, eye - 2 * reach, eye + 2 * reach));
        }

    Placement placement;
    placement.center = (all.low + all.high) / 2.0;
    const double radius = glm::length(all.high - all.low) / 2;
    if (std::isfinite(radius) && radius > 0)
        placement.scale = std::exp2(-std::ceil(std::log2(radius)));
    return placement;
}

} // namespace clrender::inline CLR_PRECISION
