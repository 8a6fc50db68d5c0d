#pragma once
/// Builds the 8-wide bounding volume hierarchy that kernels/bvh.clh walks.

#include "flatten/real.h"
#include "shared/bvh.h"
#include "shared/quadric.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace clrender::inline CLR_PRECISION {

/// A sphere of the tree; `prim` is the id that a hit reports.
struct BvhSphere {
    Vec3 center{0.0f};
    clr_real radius = 0.0f;
    uint prim = BVH_NO_PRIM;
};

/// A quadric of the tree: the box around it, and what rays are tested against (QuadricBlock), with
/// the id that a hit reports.
struct BvhQuadric {
    Vec3 lower{0.0f}, upper{0.0f};
    Vec3 center{0.0f};
    std::array<Vec3, 3> rows{};
    clr_real radius = 0.0f;
    clr_real half_length = 0.0f;
    uint kind = 0;
    uint prim = BVH_NO_PRIM;
};

/// An instance of the tree, of which only the box is known here: a leaf of its own.
struct BvhInstance {
    Vec3 lower{0.0f}, upper{0.0f};
};

/// What the search for a cheap tree believes, in units of one node visit.
struct BvhOptions {
    clr_real node_cost = 1.0f;
    /// One block of eight triangles, spheres or quadrics, whether full or not.
    clr_real block_cost = 1.0f;
    /// Levels of inner nodes, 1 to BVH_MAX_LEVELS.
    int max_levels = BVH_MAX_LEVELS;
    /// False builds on the calling thread alone; the tree is the same.
    bool parallel = true;
};

/// The tree as the device reads it. `nodes[0]` is the root and always there; each vector of blocks
/// is empty when the scene has no such primitive (OpenCL refuses buffers of no bytes).
struct Bvh {
    std::vector<BvhNode> nodes;
    std::vector<TriangleBlock> triangle_blocks;
    std::vector<SphereBlock> sphere_blocks;
    std::vector<QuadricBlock> quadric_blocks;
    /// Primitives left out: no area, a radius that is not positive, or coordinates that are not
    /// finite or beyond BVH_COORDINATE_LIMIT.
    std::size_t degenerate = 0;
    /// Primitives in the tree.
    std::size_t primitives = 0;
    /// Inner nodes on the longest way down, at most `BvhOptions::max_levels`.
    int levels = 0;
    /// Expected cost of a ray through the root's box, in the options' units.
    double cost = 0.0;
};

/// Triangle i has prim id i, instance i is child i. Coordinates are already recentred and scaled by
/// the caller. Binned SAH (Wald, "On fast construction of SAH-based bounding volume hierarchies",
/// 2007), which counts blocks in place of primitives, down to what one block holds; then the
/// cheapest 8-wide tree found by dynamic programming (Ylitie, Karras, Laine, "Efficient incoherent
/// ray traversal on GPUs through compressed wide BVHs", 2017, section 3.1). The same input gives
/// the same tree on any number of threads.
[[nodiscard]] Bvh build_bvh(std::span<const std::array<Vec3, 3>> triangles,
                            std::span<const BvhSphere> spheres = {}, const BvhOptions &options = {},
                            std::span<const BvhInstance> instances = {},
                            std::span<const BvhQuadric> quadrics = {});

} // namespace clrender::inline CLR_PRECISION
