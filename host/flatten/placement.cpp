#include "flatten_parts.h"

#include <algorithm>
#include <cmath>

namespace clrender::inline CLR_PRECISION {

namespace {

/// A piece of the scene: a shape, or a triangle of one; `size` is the diagonal of its box.
struct Part {
    glm::dvec3 center{0.0};
    double size = 0;
    double weight = 0;
};

/// Triangles of a mesh that stand for all of it.
constexpr std::size_t sampled_triangles = 512;
/// What shines counts this much: a small lamp far away is seen by its light alone.
constexpr double share_of_emitters = 0x1p-10;
/// Shapes smaller than this share of the median one count as much as one of that size.
constexpr double least_size = 0x1p-6;

double diagonal(const Box &box) {
    return glm::length(box.high - box.low);
}

void add_mesh(const Shape &shape, double weight, std::vector<Part> &parts) {
    const auto &triangles = shape.mesh->triangles;
    const std::size_t stride = (triangles.size() + sampled_triangles - 1) / sampled_triangles;
    const std::size_t first = parts.size();
    double inverse_sizes = 0;
    for (std::size_t i = 0; i < triangles.size(); i += stride) {
        Box box;
        for (const std::uint32_t vertex : triangles[i])
            box.add(glm::dvec3(shape.to_world * glm::dvec4(shape.mesh->positions[vertex], 1)));
        const double size = diagonal(box);
        if (!(size > 0) || !std::isfinite(size))
            continue;
        inverse_sizes += 1 / size;
        parts.push_back({(box.low + box.high) * 0.5, size, 1 / size});
    }
    for (std::size_t i = first; i < parts.size(); ++i)
        parts[i].weight *= weight / inverse_sizes;
}

/// The pieces, each weighted by the inverse of its size: the smaller it is, the more precision it
/// needs. A mesh weighs as much as a sphere of its size, wherever most of its small triangles are.
std::vector<Part> parts_of(const Scene &scene, const std::vector<Box> &boxes,
                           const std::vector<Box> &instance_boxes) {
    struct Whole {
        const Shape *shape;
        double size;
    };
    std::vector<Whole> wholes;
    std::vector<double> sizes;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const double size = diagonal(boxes[i]);
        if (boxes[i].empty() || !(size > 0) || !std::isfinite(size))
            continue;
        wholes.push_back({&scene.shapes[i], size});
        sizes.push_back(size);
    }
    for (const Box &box : instance_boxes)
        if (!box.empty() && diagonal(box) > 0)
            sizes.push_back(diagonal(box));
    if (sizes.empty())
        return {};
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    const double least = least_size * *middle;

    std::vector<Part> parts;
    for (const Whole &whole : wholes) {
        const double share = whole.shape->emitter == none ? 1 : share_of_emitters;
        const double weight = share / std::max(whole.size, least);
        switch (whole.shape->kind) {
        case ShapeKind::mesh:
            add_mesh(*whole.shape, weight, parts);
            break;
        case ShapeKind::sphere:
        case ShapeKind::ellipsoid:
        case ShapeKind::rectangle:
        case ShapeKind::disk:
            // A sphere's radius is a cube root, which is not rounded alike at every scale: its
            // center does not go by its box.
            parts.push_back({glm::dvec3(whole.shape->to_world[3]), whole.size, weight});
            break;
        case ShapeKind::cylinder:
            parts.push_back(
                {glm::dvec3(whole.shape->to_world * glm::dvec4(0, 0, 0.5, 1)), whole.size, weight});
            break;
        }
    }
    for (const Box &box : instance_boxes)
        if (!box.empty() && diagonal(box) > 0)
            parts.push_back(
                {(box.low + box.high) * 0.5, diagonal(box), 1 / std::max(diagonal(box), least)});
    return parts;
}

/// The value at which the weights of the parts below reach one half of all.
template <typename Value> double weighted_median(const std::vector<Part> &parts, Value value) {
    std::vector<std::pair<double, double>> sorted;
    double total = 0;
    for (const Part &part : parts) {
        sorted.emplace_back(value(part), part.weight);
        total += part.weight;
    }
    std::sort(sorted.begin(), sorted.end());
    double below = 0;
    for (const auto &[at, weight] : sorted) {
        below += weight;
        if (below >= total / 2)
            return at;
    }
    return sorted.back().first;
}

} // namespace

Placement choose_placement(const Scene &scene, const std::vector<Box> &boxes,
                           const std::vector<Box> &instance_boxes) {
    Placement placement;
    const std::vector<Part> parts = parts_of(scene, boxes, instance_boxes);
    if (parts.empty())
        return placement;
    for (int axis = 0; axis < 3; ++axis)
        placement.center[axis] =
            weighted_median(parts, [axis](const Part &part) { return part.center[axis]; });
    const double radius = weighted_median(parts, [&](const Part &part) {
        return glm::length(part.center - placement.center) + part.size / 2;
    });
    placement.scale = std::exp2(-std::ceil(std::log2(radius)));
    return placement;
}

} // namespace clrender::inline CLR_PRECISION
