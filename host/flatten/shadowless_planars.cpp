#include "flatten/shadowless_planars.h"

#include <algorithm>
#include <cmath>

namespace clrender {

namespace {

/// How far beyond a plane counts as in it, relative to the largest coordinate: what float32
/// coordinates in files lose.
constexpr double touching = 1e-6;

/// The range of n . x, less that of the plane, over what has been added.
class Sides {
public:
    explicit Sides(const Shape &planar)
        : normal_(glm::normalize(
              glm::cross(glm::dvec3(planar.to_world[0]), glm::dvec3(planar.to_world[1])))),
          place_(glm::dot(normal_, glm::dvec3(planar.to_world[3]))) {}

    void add(const glm::dvec3 &point, double radius = 0) {
        const double distance = glm::dot(normal_, point) - place_;
        low_ = std::min(low_, distance - radius);
        high_ = std::max(high_, distance + radius);
    }

    void add(const Shape &shape) {
        const glm::dvec3 center(shape.to_world[3]);
        const glm::dvec3 du(shape.to_world[0]);
        const glm::dvec3 dv(shape.to_world[1]);
        switch (shape.kind) {
        case ShapeKind::sphere:
            add(center, glm::length(du));
            break;
        case ShapeKind::rectangle:
        case ShapeKind::disk: // within the rectangle around it
            for (const double u : {-1.0, 1.0})
                for (const double v : {-1.0, 1.0})
                    add(center + u * du + v * dv);
            break;
        case ShapeKind::mesh:
            add_vertices(shape);
            break;
        }
    }

    [[nodiscard]] bool all_on_one(double tolerance) const {
        return low_ >= -tolerance || high_ <= tolerance;
    }

private:
    void add_vertices(const Shape &shape) {
        const glm::dvec3 normal = glm::transpose(glm::dmat3(shape.to_world)) * normal_;
        const double place = place_ - glm::dot(normal_, glm::dvec3(shape.to_world[3]));
        for (const glm::dvec3 &position : shape.mesh->positions) {
            const double distance = glm::dot(normal, position) - place;
            low_ = std::min(low_, distance);
            high_ = std::max(high_, distance);
        }
    }

    glm::dvec3 normal_;
    double place_;
    double low_ = 0, high_ = 0;
};

double largest_coordinate(const Shape &planar) {
    double largest = 0;
    for (int axis = 0; axis < 3; ++axis)
        largest = std::max(largest, std::abs(planar.to_world[3][axis]) +
                                        std::abs(planar.to_world[0][axis]) +
                                        std::abs(planar.to_world[1][axis]));
    return largest;
}

bool is_outer(const Scene &scene, const Shape &planar) {
    const double tolerance = touching * largest_coordinate(planar);
    Sides sides(planar);
    for (const Emitter &emitter : scene.emitters)
        if (emitter.kind == EmitterKind::point)
            sides.add(emitter.position);
    for (const Shape &shape : scene.shapes) {
        sides.add(shape);
        if (!sides.all_on_one(tolerance))
            return false;
    }
    return true;
}

/// The shape that alone shines, but for a constant environment, which is not sampled; or none.
int sole_light(const Scene &scene) {
    int sole = none;
    for (const Emitter &emitter : scene.emitters) {
        if (emitter.kind == EmitterKind::constant)
            continue;
        if (sole != none || emitter.kind != EmitterKind::area)
            return none;
        sole = emitter.shape;
    }
    return sole;
}

} // namespace

std::vector<bool> shadowless_planars(const Scene &scene) {
    std::vector<bool> shadowless(scene.shapes.size(), false);
    for (const Emitter &emitter : scene.emitters)
        if (emitter.kind == EmitterKind::envmap)
            return shadowless;
    const int light = sole_light(scene);
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
        const Shape &shape = scene.shapes[i];
        if (shape.kind == ShapeKind::rectangle || shape.kind == ShapeKind::disk)
            shadowless[i] = static_cast<int>(i) == light || is_outer(scene, shape);
    }
    return shadowless;
}

} // namespace clrender
