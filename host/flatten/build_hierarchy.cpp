#include "flat_scene.h"
#include "log.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <tbb/parallel_for.h>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Part of a group's tree, by its middle and half its size.
struct PartBox {
    glm::dvec3 middle, half;
};

/// The boxes two levels below a tree's root: closer to what it holds than its own.
std::vector<PartBox> part_boxes(const Bvh &tree) {
    std::vector<PartBox> parts;
    const auto add_children = [&](const BvhNode &node, const auto &take) {
        for (std::size_t slot = 0; slot < BVH_WIDTH; ++slot) {
            glm::dvec3 low, high;
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = node.planes[BVH_PLANE_LOWER + static_cast<uint>(axis)][slot];
                high[axis] = node.planes[BVH_PLANE_UPPER + static_cast<uint>(axis)][slot];
            }
            if (low.x <= high.x)
                take(node.child[slot], PartBox{(low + high) * 0.5, (high - low) * 0.5});
        }
    };
    add_children(tree.nodes.front(), [&](uint child, const PartBox &box) {
        if (bvh_child_kind(child) == BVH_CHILD_INNER)
            add_children(tree.nodes[bvh_child_index(child)],
                         [&](uint, const PartBox &inner) { parts.push_back(inner); });
        else
            parts.push_back(box);
    });
    return parts;
}

/// The box of an instance in the renderer's coordinates, wider by what a ray's way to the group's
/// coordinates loses to rounding.
BvhInstance box_of(const Instance &instance, const std::vector<PartBox> &parts) {
    const auto vector = [](const clr_real(&v)[3]) { return glm::dvec3(v[0], v[1], v[2]); };
    const glm::dmat3 to_group(vector(instance.x), vector(instance.y), vector(instance.z));
    const glm::dmat3 out = glm::inverse(to_group);
    const glm::dmat3 size(glm::abs(out[0]), glm::abs(out[1]), glm::abs(out[2]));
    const double lost = 4 * static_cast<double>(BVH_WIDEN) * static_cast<double>(instance.slack);
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const PartBox &part : parts) {
        const glm::dvec3 middle = out * (part.middle - vector(instance.origin));
        const glm::dvec3 half = size * (part.half + lost);
        low = glm::min(low, middle - half);
        high = glm::max(high, middle + half);
    }
    return {Vec3(low), Vec3(high)};
}

/// Appends a group's tree, whose primitives count from `first_triangle` in the scene.
void append_tree(const Bvh &tree, std::size_t first_triangle, FlatScene &flat) {
    const auto first_node = static_cast<uint>(flat.nodes.size());
    const auto first_block = static_cast<uint>(flat.triangle_blocks.size());
    for (BvhNode node : tree.nodes) {
        node.parent += first_node;
        for (uint &child : node.child) {
            if (child == BVH_NO_CHILD)
                continue;
            const bool is_node = bvh_child_kind(child) == BVH_CHILD_INNER;
            child += is_node ? first_node : first_block;
        }
        flat.nodes.push_back(node);
    }
    for (TriangleBlock block : tree.triangle_blocks) {
        for (clr_word &prim : block.prim)
            prim += static_cast<clr_word>(first_triangle);
        flat.triangle_blocks.push_back(block);
    }
}

/// Builds the groups' trees, and the boxes of their instances.
std::vector<BvhInstance> build_groups(const FlatScene &flat, std::vector<Bvh> &trees) {
    std::vector<std::vector<PartBox>> parts;
    for (const FlatGroup &group : flat.groups) {
        trees.push_back(build_bvh(std::span(flat.corners).subspan(group.first, group.count)));
        parts.push_back(part_boxes(trees.back()));
    }
    std::vector<BvhInstance> boxes(trees.empty() ? 0 : flat.instances.size());
    tbb::parallel_for(std::size_t(0), boxes.size(), [&](std::size_t i) {
        boxes[i] = box_of(flat.instances[i], parts[flat.instances[i].root]);
    });
    return boxes;
}

} // namespace

void build_hierarchy(FlatScene &flat) {
    std::vector<Bvh> trees;
    const std::vector<BvhInstance> instances = build_groups(flat, trees);
    const std::size_t own = flat.groups.empty() ? flat.corners.size() : flat.groups.front().first;
    Bvh bvh = build_bvh(std::span(flat.corners).first(own), flat.bvh_spheres, {}, instances,
                        flat.bvh_quadrics);
    // An empty list in place of an empty vector would keep the memory.
    flat.corners = std::vector<TriangleCorners>();
    flat.bvh_spheres = std::vector<BvhSphere>();
    flat.bvh_quadrics = std::vector<BvhQuadric>();
    flat.nodes = std::move(bvh.nodes);
    flat.triangle_blocks = std::move(bvh.triangle_blocks);
    flat.sphere_blocks = std::move(bvh.sphere_blocks);
    flat.quadric_blocks = std::move(bvh.quadric_blocks);
    flat.frame.triangle_blocks = static_cast<uint>(flat.triangle_blocks.size());
    flat.frame.sphere_blocks = static_cast<uint>(flat.sphere_blocks.size());
    flat.frame.quadric_blocks = static_cast<uint>(flat.quadric_blocks.size());

    std::size_t degenerate = bvh.degenerate;
    std::vector<uint> roots;
    for (std::size_t i = 0; i < trees.size(); ++i) {
        roots.push_back(static_cast<uint>(flat.nodes.size()));
        append_tree(trees[i], flat.groups[i].first, flat);
        degenerate += trees[i].degenerate;
        trees[i] = Bvh();
    }
    if (!roots.empty())
        for (Instance &instance : flat.instances)
            instance.root = roots[instance.root];
    if (degenerate > 0)
        log::warn(fmt::format("{} triangles or spheres without area are left out", degenerate));
}

} // namespace clrender::inline CLR_PRECISION
