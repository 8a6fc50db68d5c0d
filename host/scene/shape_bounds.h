#pragma once
/// The extent of shapes in world coordinates, in double precision.

#include "scene.h"

#include <algorithm>
#include <array>
#include <limits>

namespace clrender {

struct Box {
    glm::dvec3 low{std::numeric_limits<double>::infinity()};
    glm::dvec3 high{-std::numeric_limits<double>::infinity()};

    void add(const glm::dvec3 &p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    void add(const Box &other) {
        low = glm::min(low, other.low);
        high = glm::max(high, other.high);
    }
    [[nodiscard]] bool empty() const { return !(low.x <= high.x); }
    [[nodiscard]] std::array<glm::dvec3, 8> corners() const {
        std::array<glm::dvec3, 8> all;
        for (std::size_t i = 0; i < all.size(); ++i)
            all[i] = {(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                      (i & 4) != 0 ? high.z : low.z};
        return all;
    }
};

/// The range of a coordinate; nothing is in it where low > high.
struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();

    void add(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
};

/// The box of a shape; of a disk that of the rectangle around it.
Box shape_box(const Shape &shape);

/// The box of a group in its own coordinates.
Box group_box(const ShapeGroup &group);

/// The box of a box that an instance places.
Box placed_box(const ShapeInstance &instance, const Box &group);

/// The boxes of the scene's instances, in their order.
std::vector<Box> instance_boxes(const Scene &scene);

/// How far a shape reaches along `axis`, measured from `origin`: for spheres, ellipsoids and
/// cylinders exactly, for others as far as their `box` does, which is shape_box().
Range shape_range(const Shape &shape, const Box &box, const glm::dvec3 &origin,
                  const glm::dvec3 &axis);

/// The same of a box.
Range box_range(const Box &box, const glm::dvec3 &origin, const glm::dvec3 &axis);

/// How much longer than 1 a matrix makes vectors of length 1 at most.
double largest_stretch(const glm::dmat3 &matrix);

/// Whether `to_world` makes an ellipsoid, cylinder or disk so thin that its float32 record would
/// say little of it: the largest over the smallest stretch.
bool is_nearly_singular(const glm::dmat3 &to_world);

/// Radius of a sphere: the cube root of the volume that to_world gives a unit cube.
double sphere_radius(const Shape &shape);

} // namespace clrender
