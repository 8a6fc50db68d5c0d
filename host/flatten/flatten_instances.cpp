#include "log.h"
#include "shape_parts.h"

#include <cmath>
#include <glm/gtc/matrix_inverse.hpp>
#include <tbb/parallel_for.h>

namespace clrender::inline CLR_PRECISION {

namespace {

/// The coordinates of a group: its box lies around the origin, and reaches about a unit far.
Placement group_placement(const Box &box) {
    Placement placement;
    placement.center = (box.low + box.high) * 0.5;
    const double radius = glm::length(box.high - box.low) / 2;
    if (radius > 0 && std::isfinite(radius))
        placement.scale = std::exp2(-std::ceil(std::log2(radius)));
    return placement;
}

/// How far from 0 the coordinates of a box reach.
glm::dvec3 reach_of(const Box &box, const Placement &placement) {
    return glm::max(glm::abs(placement.exact(box.low)), glm::abs(placement.exact(box.high)));
}

/// The map from the renderer's coordinates to those of `group`, in which `number` is its index.
Instance make_instance(const ShapeInstance &shape, const Placement &scene, const Placement &group,
                       const glm::dvec3 &reach, uint number) {
    const glm::dmat3 linear(shape.to_world);
    const glm::dmat3 inverse = glm::inverse(linear);
    const glm::dmat3 m = inverse * (group.scale / scene.scale);
    const glm::dvec3 origin =
        (inverse * (scene.center - shape.to_world[3]) - group.center) * group.scale;
    Instance result{};
    store(result.x, m[0]);
    store(result.y, m[1]);
    store(result.z, m[2]);
    store(result.origin, origin);
    const glm::dvec3 sums =
        glm::abs(m[0]) * reach.x + glm::abs(m[1]) * reach.y + glm::abs(m[2]) * reach.z;
    const glm::dvec3 largest = sums + glm::abs(origin);
    result.slack = static_cast<clr_real>(std::max({largest.x, largest.y, largest.z}));
    result.root = number;
    return result;
}

} // namespace

void flatten_instances(Flattening &work) {
    FlatScene &flat = work.flat;
    const Scene &scene = work.scene;
    std::vector<Placement> placements;
    std::vector<uint> number_of(scene.groups.size(), CLR_NONE); // among the groups in use
    for (const ShapeInstance &instance : scene.instances) {
        uint &number = number_of[static_cast<std::size_t>(instance.group)];
        const ShapeGroup &group = scene.groups[static_cast<std::size_t>(instance.group)];
        const Box box = number == CLR_NONE ? group_box(group) : Box{};
        if (box.empty())
            continue; // known already, or nothing to see
        number = static_cast<uint>(flat.groups.size());
        placements.push_back(group_placement(box));
        const std::size_t first = flat.corners.size();
        for (const Shape &shape : group.shapes)
            append_triangles(shape, placements.back(), work);
        flat.groups.push_back({first, flat.corners.size() - first});
    }
    std::vector<std::size_t> shown;
    for (std::size_t i = 0; i < scene.instances.size(); ++i)
        if (number_of[static_cast<std::size_t>(scene.instances[i].group)] != CLR_NONE)
            shown.push_back(i);
    flat.instances.resize(shown.size());
    if (work.options.first_hits)
        for (const std::size_t i : shown)
            flat.hits.instance_objects.push_back(scene.instances[i].object);
    tbb::parallel_for(std::size_t(0), shown.size(), [&](std::size_t i) {
        const ShapeInstance &instance = scene.instances[shown[i]];
        const uint number = number_of[static_cast<std::size_t>(instance.group)];
        flat.instances[i] =
            make_instance(instance, flat.placement, placements[number],
                          reach_of(work.instance_boxes[shown[i]], flat.placement), number);
    });
    if (work.options.brute_force && !flat.instances.empty())
        log::warn("--accel none: instances are found through their tree all the same");
    if (work.wants("HAS_INSTANCES") && flat.instances.empty())
        flat.instances.emplace_back();
    flat.triangle_count = flat.corners.size();
}

} // namespace clrender::inline CLR_PRECISION
