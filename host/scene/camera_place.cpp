#include "camera_place.h"

#include "../log.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace clrender {

namespace {

/// The solid angle of a triangle, seen from the origin; positive where its front shows away from
/// there (Van Oosterom and Strackee 1983).
double solid_angle(const glm::dvec3 &a, const glm::dvec3 &b, const glm::dvec3 &c) {
    const double la = glm::length(a);
    const double lb = glm::length(b);
    const double lc = glm::length(c);
    return 2 *
           std::atan2(glm::dot(a, glm::cross(b, c)), la * lb * lc + glm::dot(a, b) * lc +
                                                         glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

/// How often a mesh goes around a point: 1 or -1 inside of a closed one, by its orientation.
double winding_number(const Shape &shape, const glm::dvec3 &point) {
    const Mesh &mesh = *shape.mesh;
    const auto seen = [&](std::uint32_t vertex) {
        return glm::dvec3(shape.to_world * glm::dvec4(mesh.positions[vertex], 1)) - point;
    };
    const double sum = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), 4096), 0.0,
        [&](const tbb::blocked_range<std::size_t> &range, double partial) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const auto &t = mesh.triangles[i];
                partial += solid_angle(seen(t[0]), seen(t[1]), seen(t[2]));
            }
            return partial;
        },
        std::plus<>());
    return sum / (4 * std::numbers::pi);
}

/// Whether the shape is around the point and turns its back to it.
bool encloses(const Shape &shape, const glm::dvec3 &point) {
    if (shape.kind == ShapeKind::mesh) {
        const double winding = winding_number(shape, point);
        return (shape.flip_normals ? -winding : winding) > 0.99;
    }
    if (shape.kind != ShapeKind::sphere && shape.kind != ShapeKind::ellipsoid)
        return false;
    const bool outwards = (glm::determinant(glm::dmat3(shape.to_world)) > 0) != shape.flip_normals;
    return outwards &&
           glm::length(glm::dvec3(glm::inverse(shape.to_world) * glm::dvec4(point, 1))) < 1;
}

} // namespace

void warn_of_enclosed_camera(const Scene &scene) {
    const glm::dvec3 eye(scene.sensor.to_world[3]);
    for (const Shape &shape : scene.shapes) {
        if (shape.bsdf == none || shape.emitter != none)
            continue;
        const BsdfModel &model = scene.bsdfs[static_cast<std::size_t>(shape.bsdf)].model;
        const bool is_glass = std::holds_alternative<DielectricBsdf>(model) ||
                              std::holds_alternative<RoughDielectricBsdf>(model);
        if (std::holds_alternative<TwosidedBsdf>(model) || !encloses(shape, eye) ||
            (lets_light_through(scene, shape.bsdf) && !is_glass))
            continue;
        log::warn(shape.where, is_glass
                                   ? "the camera is inside of this solid of glass"
                                   : "the camera is inside of this solid: it sees a black inner "
                                     "side");
    }
}

} // namespace clrender
