#include "flatten/shadowless_planars.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clrender::inline CLR_PRECISION {

namespace {

/// What sums and products of doubles lose, relative to the largest of them.
constexpr double lost_by_doubles = 1e-14;

double largest(const glm::dvec3 &v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Whether what has been added reaches to either side of a plane.
class Sides {
public:
    Sides(const Shape &planar, double touching)
        : normal_(glm::normalize(
              glm::cross(glm::dvec3(planar.to_world[0]), glm::dvec3(planar.to_world[1])))),
          origin_(planar.to_world[3]), touching_(touching) {
        // The normal's own rounding shows at the far corners.
        for (const int axis : {0, 1, 3})
            touching_ += lost_by_doubles * largest(glm::dvec3(planar.to_world[axis]));
    }

    /// A point of the world, or a ball around it.
    void add(const glm::dvec3 &point, double radius = 0) {
        const double distance = glm::dot(normal_, point - origin_);
        const double tolerance = touching_ + lost_by_doubles * (largest(point) + radius);
        below_ |= distance - radius < -tolerance;
        above_ |= distance + radius > tolerance;
    }

    [[nodiscard]] bool both() const { return below_ && above_; }

private:
    glm::dvec3 normal_, origin_;
    double touching_;
    bool below_ = false, above_ = false;
};

glm::dvec3 placed(const Shape &shape, const glm::dvec3 &position) {
    return {shape.to_world * glm::dvec4(position, 1)};
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

ShadowlessPlanars::ShadowlessPlanars(const Scene &scene, double touching)
    : scene_(scene), touching_(touching), sole_light_(sole_light(scene)) {
    has_map_ =
        std::any_of(scene.emitters.begin(), scene.emitters.end(),
                    [](const Emitter &emitter) { return emitter.kind == EmitterKind::envmap; });
    if (has_map_)
        return; // nobody asks for the boxes
    for (const Shape &shape : scene.shapes) {
        if (shape.kind != ShapeKind::mesh || boxes_.count(shape.mesh.get()) != 0)
            continue;
        glm::dvec3 low(std::numeric_limits<double>::infinity());
        glm::dvec3 high = -low;
        for (const glm::dvec3 &position : shape.mesh->positions) {
            low = glm::min(low, position);
            high = glm::max(high, position);
        }
        auto &corners = boxes_[shape.mesh.get()];
        for (std::size_t i = 0; i < corners.size(); ++i)
            corners[i] = {(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                          (i & 4) != 0 ? high.z : low.z};
    }
}

bool ShadowlessPlanars::is_outer(const Shape &planar) const {
    Sides sides(planar, touching_);
    for (const Emitter &emitter : scene_.emitters)
        if (emitter.kind == EmitterKind::point)
            sides.add(emitter.position);
    for (const Shape &shape : scene_.shapes) {
        const glm::dvec3 center(shape.to_world[3]);
        if (shape.kind == ShapeKind::sphere) {
            sides.add(center, glm::length(glm::dvec3(shape.to_world[0])));
        } else if (shape.kind != ShapeKind::mesh) {
            // A disk lies within the rectangle around it.
            for (const double u : {-1.0, 1.0})
                for (const double v : {-1.0, 1.0})
                    sides.add(placed(shape, {u, v, 0}));
        } else if (!shape.mesh->positions.empty()) {
            Sides with_box = sides;
            for (const glm::dvec3 &corner : boxes_.at(shape.mesh.get()))
                with_box.add(placed(shape, corner));
            if (with_box.both()) // the box may reach farther than the mesh
                for (const glm::dvec3 &position : shape.mesh->positions)
                    sides.add(placed(shape, position));
            else
                sides = with_box;
        }
        if (sides.both())
            return false;
    }
    return true;
}

bool ShadowlessPlanars::contains(std::size_t shape) const {
    const Shape &planar = scene_.shapes.at(shape);
    if (has_map_ || (planar.kind != ShapeKind::rectangle && planar.kind != ShapeKind::disk))
        return false;
    return static_cast<int>(shape) == sole_light_ || is_outer(planar);
}

} // namespace clrender::inline CLR_PRECISION
