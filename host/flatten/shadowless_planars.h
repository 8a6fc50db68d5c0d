#pragma once
/// Walls, floors and ceilings cast no shadows into their own room.

#include "scene/shape_bounds.h"
#include "shared/shared_types.h"

#include <cstddef>
#include <map>

namespace clrender::inline CLR_PRECISION {

/// The rectangles and disks of a scene that never come between a point of a surface and a point of
/// a light: all shapes and point lights lie in their plane or on one side of it, or they are the
/// only light themselves. None does, where light comes from outside of the scene and is sampled.
class ShadowlessPlanars {
public:
    /// Whatever reaches through a plane by no more than `touching` counts as lying on one side.
    ShadowlessPlanars(const Scene &scene, double touching);

    /// Whether `shape`, an index into Scene::shapes, is one of them.
    [[nodiscard]] bool contains(std::size_t shape) const;

private:
    class Sides;

    [[nodiscard]] bool is_outer(const Shape &planar) const;
    void add_mesh(const Shape &shape, Sides &sides) const;

    const Scene &scene_;
    double touching_;
    bool lit_from_outside_ = false;
    int sole_light_ = none;
    std::map<const Mesh *, Box> boxes_; ///< in their own space
    std::vector<Box> instance_boxes_;
};

} // namespace clrender::inline CLR_PRECISION
