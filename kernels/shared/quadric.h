#ifndef CLR_SHARED_QUADRIC_H
#define CLR_SHARED_QUADRIC_H
/* Ellipsoids, open elliptic cylinders and ellipses as the device reads them. */

#include "shared/bvh.h"
#include "shared/shared_types.h"

#define CLR_QUADRIC_ELLIPSOID 0u
#define CLR_QUADRIC_CYLINDER 1u
#define CLR_QUADRIC_DISK 2u

CLR_PRECISION_BEGIN

/* A linear map makes a quadric round: p' = (x . w, y . w, z . w) with w = p - center are its own
   coordinates. In these an ellipsoid is |p'| = radius; a cylinder is p'.x^2 + p'.y^2 = radius^2
   with |p'.z| <= half_length; a disk is p'.x^2 + p'.y^2 <= radius^2 with p'.z = 0. None of x, y, z
   is longer than 1, so own coordinates overflow no sooner than the scene's. Back again p = center +
   from_x p'.x + from_y p'.y + from_z p'.z, whose determinant is `volume`, without its sign.
   `orientation` is 1 where the normal points outwards (disk: along z), or -1. Hits of cylinders are
   kept to |p'.z| <= rim, those of disks to that radius: so none lies behind a surface that shares
   the outline (see planar_keep_inside). */
typedef struct {
    clr_real center[3];
    clr_word kind;
    clr_real x[3];
    clr_real radius;
    clr_real y[3];
    clr_real half_length;
    clr_real z[3];
    clr_real orientation;
    clr_real from_x[3];
    clr_real volume;
    clr_real from_y[3];
    clr_real rim;
    clr_real from_z[3];
    clr_real pad[5];
} Quadric;
CLR_STATIC_WORDS(Quadric, 32);

/* What rays are tested against, eight side by side; `rows` are x, y and z. Cylinders are longer and
   disks are wider here by what the test may lose to rounding; half_length is infinite for
   ellipsoids. Unused lanes repeat lane 0. */
typedef struct CLR_ALIGNED(64) QuadricBlock {
    clr_real center[3][BVH_WIDTH];
    clr_real rows[3][3][BVH_WIDTH];
    clr_real radius[BVH_WIDTH];
    clr_real half_length[BVH_WIDTH];
    clr_word kind[BVH_WIDTH];
    clr_word prim[BVH_WIDTH];
} QuadricBlock;
CLR_STATIC_WORDS(QuadricBlock, 128);

CLR_PRECISION_END
#endif
