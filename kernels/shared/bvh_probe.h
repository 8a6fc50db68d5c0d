#ifndef CLR_SHARED_BVH_PROBE_H
#define CLR_SHARED_BVH_PROBE_H
/* Rays into, and hits out of, kernels/probes/bvh_probes.cl. */

#include "shared/shared_types.h"

/* As a hit's prim: the ray was not traced, for the rays beside it go other ways. */
#define BVH_PROBE_NOT_TRACED 0xfffffffeu

CLR_SHARED_BEGIN

typedef struct CLR_ALIGNED(32) BvhProbeRay {
    float o[3];  /*  0 */
    float t_max; /* 12 */
    float d[3];  /* 16 */
    uint self;   /* 28 */
} BvhProbeRay;
CLR_STATIC_SIZE(BvhProbeRay, 32);

typedef struct CLR_ALIGNED(16) BvhProbeHit {
    float t;   /*  0 */
    uint prim; /*  4: BVH_NO_PRIM for a miss */
    float u;   /*  8 */
    float v;   /* 12 */
} BvhProbeHit;
CLR_STATIC_SIZE(BvhProbeHit, 16);

CLR_SHARED_END
#endif
