#include "flatten/shadowless_planars.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace clrender::inline CLR_PRECISION {

namespace {

/// What sums and products of doubles lose, relative to the largest of them.
constexpr double lost_by_doubles = 1e-14;

double largest(const glm::dvec3 &v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

glm::dvec3 placed(const Shape &shape, const glm::dvec3 &position) {
    return {shape.to_world * glm::dvec4(position, 1)};
}

/// The shape that alone shines, but for a constant environment, which is not sampled; or none.
int sole_light(const Scene &scene) {
    int sole = none;
    for (const Emitter &emitter : scene.emitters) {
        switch (emitter.kind) {
        case EmitterKind::constant:
            break;
        case EmitterKind::point:
        case EmitterKind::spot:
        case EmitterKind::projector:
        case EmitterKind::directional:
        case EmitterKind::envmap:
        case EmitterKind::sunsky:
            return none;
        case EmitterKind::area:
            if (sole != none)
                return none;
            sole = emitter.shape;
            break;
        }
    }
    return sole;
}

/// Whether the emitter's samples may come from beyond all shapes.
bool is_outside(const Emitter &emitter) {
    return emitter.kind == EmitterKind::envmap || emitter.kind == EmitterKind::directional ||
           emitter.kind == EmitterKind::sunsky;
}

/// The place of a light that has one and no shape.
std::optional<glm::dvec3> place_of(const Emitter &emitter) {
    switch (emitter.kind) {
    case EmitterKind::point:
        return emitter.position;
    case EmitterKind::spot:
    case EmitterKind::projector:
        return glm::dvec3(emitter.to_world[3]);
    case EmitterKind::area:
    case EmitterKind::constant:
    case EmitterKind::envmap:
    case EmitterKind::directional:
    case EmitterKind::sunsky:
        break;
    }
    return std::nullopt;
}

} // namespace

/// Whether what has been added reaches to either side of a plane.
class ShadowlessPlanars::Sides {
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

    /// What reaches so far along the normal, and lies in the box.
    void add(const Range &range, const Box &box) {
        const double tolerance =
            touching_ + lost_by_doubles * std::max(largest(box.low), largest(box.high));
        below_ |= range.low < -tolerance;
        above_ |= range.high > tolerance;
    }

    [[nodiscard]] bool both() const { return below_ && above_; }
    [[nodiscard]] const glm::dvec3 &normal() const { return normal_; }
    [[nodiscard]] const glm::dvec3 &origin() const { return origin_; }

private:
    glm::dvec3 normal_, origin_;
    double touching_;
    bool below_ = false, above_ = false;
};

ShadowlessPlanars::ShadowlessPlanars(const Scene &scene, double touching)
    : scene_(scene), touching_(touching), sole_light_(sole_light(scene)) {
    lit_from_outside_ = std::any_of(scene.emitters.begin(), scene.emitters.end(), is_outside);
    if (lit_from_outside_)
        return; // nobody asks for the boxes
    instance_boxes_ = instance_boxes(scene);
    for (const Shape &shape : scene.shapes) {
        if (shape.kind != ShapeKind::mesh || boxes_.count(shape.mesh.get()) != 0)
            continue;
        Box box;
        for (const glm::dvec3 &position : shape.mesh->positions)
            box.add(position);
        boxes_[shape.mesh.get()] = box;
    }
}

void ShadowlessPlanars::add_mesh(const Shape &shape, Sides &sides) const {
    const Box &box = boxes_.at(shape.mesh.get());
    if (box.empty())
        return;
    Sides with_box = sides;
    for (const glm::dvec3 &corner : box.corners())
        with_box.add(placed(shape, corner));
    if (!with_box.both()) {
        sides = with_box;
        return;
    }
    // The box may reach farther than the mesh.
    for (const glm::dvec3 &position : shape.mesh->positions)
        sides.add(placed(shape, position));
}

bool ShadowlessPlanars::is_outer(const Shape &planar) const {
    Sides sides(planar, touching_);
    for (const Emitter &emitter : scene_.emitters)
        if (const auto place = place_of(emitter))
            sides.add(*place);
    for (const Shape &shape : scene_.shapes) {
        switch (shape.kind) {
        case ShapeKind::sphere:
            sides.add(glm::dvec3(shape.to_world[3]), glm::length(glm::dvec3(shape.to_world[0])));
            break;
        case ShapeKind::ellipsoid:
        case ShapeKind::cylinder:
            sides.add(shape_range(shape, Box{}, sides.origin(), sides.normal()), shape_box(shape));
            break;
        case ShapeKind::rectangle:
        case ShapeKind::disk: // which lies within the rectangle around it
            for (const double u : {-1.0, 1.0})
                for (const double v : {-1.0, 1.0})
                    sides.add(placed(shape, {u, v, 0}));
            break;
        case ShapeKind::mesh:
            add_mesh(shape, sides);
            break;
        }
        if (sides.both())
            return false;
    }
    for (const Box &box : instance_boxes_) {
        if (!box.empty())
            for (const glm::dvec3 &corner : box.corners())
                sides.add(corner);
        if (sides.both())
            return false;
    }
    return true;
}

bool ShadowlessPlanars::contains(std::size_t shape) const {
    const Shape &planar = scene_.shapes.at(shape);
    if (lit_from_outside_ ||
        (planar.kind != ShapeKind::rectangle && planar.kind != ShapeKind::disk))
        return false;
    return static_cast<int>(shape) == sole_light_ || is_outer(planar);
}

} // namespace clrender::inline CLR_PRECISION
