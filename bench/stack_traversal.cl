/* What the stackless traversal of bvh.clh is compared with: the same tree, boxes and blocks, but
   the children that a ray has still to visit lie on a stack of its own, with their distances, so
   that no box is tested twice. For the benchmark alone. */

#include "probes/probe_rays.clh"

#define STACK_SIZE (7 * BVH_MAX_LEVELS + 1)

/* Puts the children in `bits` on the stack, the nearest on top. */
static inline uint stack_push(uint *children, float *entries, uint top,
                              __global const BvhNode *node, uint bits, const float *entry_of) {
    const uint base = top;
    for (; bits != 0u; bits &= bits - 1u) {
        const uint slot = bvh_lowest_bit(bits);
        uint place = top++;
        for (; place > base && entries[place - 1u] < entry_of[slot]; --place) {
            entries[place] = entries[place - 1u];
            children[place] = children[place - 1u];
        }
        entries[place] = entry_of[slot];
        children[place] = node->child[slot];
    }
    return top;
}

/* As bvh_closest. */
static inline int stack_closest(__global const BvhNode *nodes,
                                __global const TriangleBlock *triangles,
                                __global const SphereBlock *spheres, const BvhRay *ray,
                                BvhHit *result) {
    BvhHit hit = {scalar_below(result->t), 0.0f, 0.0f, BVH_NO_PRIM, 0u};
    uint children[STACK_SIZE];
    float entries[STACK_SIZE];
    children[0] = bvh_child(BVH_CHILD_INNER, 0u);
    entries[0] = 0.0f;
    uint top = 1u;
    while (top != 0u) {
        const uint child = children[--top];
        if (entries[top] > hit.t) {
            continue;
        }
        if (bvh_child_kind(child) == BVH_CHILD_INNER) {
            __global const BvhNode *node = nodes + bvh_child_index(child);
            float entry_of[BVH_WIDTH];
            const uint bits = bvh_meet_boxes(node, ray, hit.t, entry_of);
            top = stack_push(children, entries, top, node, bits, entry_of);
        } else {
            bvh_visit_block(triangles, spheres, child, ray, &hit);
        }
    }
    if (hit.prim == BVH_NO_PRIM) {
        return 0;
    }
    *result = hit;
    return 1;
}

/* As bvh_any. */
static inline int stack_any(__global const BvhNode *nodes, __global const TriangleBlock *triangles,
                            __global const SphereBlock *spheres, const BvhRay *ray, float t_max) {
    const float t_end = scalar_below(t_max);
    uint children[STACK_SIZE];
    children[0] = bvh_child(BVH_CHILD_INNER, 0u);
    uint top = 1u;
    while (top != 0u) {
        const uint child = children[--top];
        if (bvh_child_kind(child) == BVH_CHILD_INNER) {
            __global const BvhNode *node = nodes + bvh_child_index(child);
            float entry_of[BVH_WIDTH];
            uint bits = bvh_meet_boxes(node, ray, t_end, entry_of);
            for (; bits != 0u; bits &= bits - 1u) {
                children[top++] = node->child[bvh_lowest_bit(bits)];
            }
        } else if (bvh_meets_block(triangles, spheres, child, ray, t_end)) {
            return 1;
        }
    }
    return 0;
}

PROBE_CLOSEST(bench_stack_closest, stack_closest)
PROBE_ANY(bench_stack_any, stack_any)
