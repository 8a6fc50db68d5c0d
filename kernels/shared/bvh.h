#ifndef CLR_SHARED_BVH_H
#define CLR_SHARED_BVH_H
/* The acceleration structure as the device reads it: an 8-wide bounding volume hierarchy whose
   leaves are blocks of up to eight primitives of one kind. Everything is laid out component by
   component, so that one ray meets all children of a node, or all primitives of a block, in one
   vector operation. host/flatten/bvh_builder.h fills it, kernels/bvh.clh walks it. */

#include "shared/shared_types.h"

/* Children of a node, and primitives of a block. */
#define BVH_WIDTH 8
/* Inner nodes on the longest way down: one byte of the ray's trail each (two 64-bit words). */
#define BVH_MAX_LEVELS 16
/* "No primitive": as the ray's own primitive nothing is excluded, as a result nothing was hit. */
#define BVH_NO_PRIM 0xffffffffu
/* Coordinates beyond this are neither stored nor traversed, so that no product overflows. */
#define BVH_COORDINATE_LIMIT 0x1p53f
/* Boxes are wider than their contents by this share of their largest coordinate; see bvh_ray.clh.
 */
#define BVH_WIDEN CLR_EITHER(2.4e-7f, 4.5e-16)
/* An empty child's box is turned inside out: from +this to -this. */
#define BVH_EMPTY_BOUND 0x1p60f

/* The planes of a node's children in BvhNode::planes: lower x, y, z, then upper x, y, z. */
#define BVH_PLANE_LOWER 0u
#define BVH_PLANE_UPPER 3u

/* What a child reference names: its two highest bits. */
#define BVH_CHILD_INNER 0u
#define BVH_CHILD_TRIANGLES 1u
#define BVH_CHILD_SPHERES 2u
#define BVH_CHILD_INSTANCE 3u
/* A block of spheres whose index has this bit is one of quadrics (quadric.h). */
#define BVH_QUADRICS_BIT 0x20000000u
/* An empty child, whose box no ray meets: no other names the root. */
#define BVH_NO_CHILD 0u

CLR_PRECISION_BEGIN

typedef struct CLR_ALIGNED(64) BvhNode {
    clr_real planes[6][BVH_WIDTH]; /*   0: boxes of the children */
    uint child[BVH_WIDTH];         /* 192: references, see bvh_child_* */
    uint parent;                   /* 224: index of the node above; the root names itself */
    clr_real bounds[6]; /* 228: of the root only: lower and upper corner of the whole tree */
} BvhNode;
CLR_STATIC_WORDS(BvhNode, 64);

/* Unused lanes repeat lane 0, primitive and all: hitting it twice changes nothing. */
typedef struct CLR_ALIGNED(64) TriangleBlock {
    clr_real vertex[3][3][BVH_WIDTH]; /*   0: corner, axis, lane */
    clr_word prim[BVH_WIDTH];         /* 288 */
} TriangleBlock;
CLR_STATIC_WORDS(TriangleBlock, 80);

typedef struct CLR_ALIGNED(32) SphereBlock {
    clr_real center[3][BVH_WIDTH]; /*   0: axis, lane */
    clr_real radius[BVH_WIDTH];    /*  96 */
    clr_word prim[BVH_WIDTH];      /* 128 */
} SphereBlock;
CLR_STATIC_WORDS(SphereBlock, 40);

/* A reference to a node, a block or an instance; `index` has 30 bits. */
static inline uint bvh_child(uint kind, uint index) {
    return (kind << 30) | index;
}
static inline uint bvh_child_kind(uint child) {
    return child >> 30;
}
static inline uint bvh_child_index(uint child) {
    return child & 0x3fffffffu;
}
static inline int bvh_child_is_quadrics(uint child) {
    return bvh_child_kind(child) == BVH_CHILD_SPHERES && (child & BVH_QUADRICS_BIT) != 0u;
}
static inline uint bvh_quadrics_index(uint child) {
    return child & (BVH_QUADRICS_BIT - 1u);
}

CLR_PRECISION_END
#endif
