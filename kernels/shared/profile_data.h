#ifndef CLR_PROFILE_DATA_H
#define CLR_PROFILE_DATA_H
/* What a kernel counts when it is compiled with PROFILE. */

#include "shared/shared_types.h"

CLR_SHARED_BEGIN

/* Rays and bounces are counted lane by lane; steps, nodes and blocks as often as the instructions
   run. The kinds of blocks follow one another as the kinds of children do. */
enum ProfileCounter {
    PROFILE_CAMERA_RAYS,
    PROFILE_PATH_RAYS, /* camera rays and bounces */
    PROFILE_SHADOW_RAYS,
    PROFILE_BOUNCES,      /* vertices that scatter */
    PROFILE_STEPS,        /* iterations of the bounce loop, each for all lanes */
    PROFILE_SHADOW_STEPS, /* those in which a lane traces a shadow ray */
    PROFILE_PATH_NODES,   /* nodes whose boxes a camera or bounce ray tests */
    PROFILE_PATH_TRIANGLE_BLOCKS,
    PROFILE_PATH_SPHERE_BLOCKS,
    PROFILE_SHADOW_NODES,
    PROFILE_SHADOW_TRIANGLE_BLOCKS,
    PROFILE_SHADOW_SPHERE_BLOCKS,
    PROFILE_PACKETS,      /* camera rays that were traced all at once, and how many they were: */
    PROFILE_PACKET_RAYS,  /* not in the nodes and blocks of the single ones above */
    PROFILE_PACKET_NODES, /* once for all rays of a packet */
    PROFILE_PACKET_TRIANGLE_BLOCKS,
    PROFILE_PACKET_SPHERE_BLOCKS,
    PROFILE_COUNTERS
};

/* Work-items share so many sums, so that what is read back does not grow with the picture. */
#define PROFILE_SLOTS 1024

/* Sums over work-items and launches: low and high half of each. */
typedef struct {
    uint count[PROFILE_COUNTERS][2];
} ProfileCounters;
CLR_STATIC_SIZE(ProfileCounters, 136);

CLR_SHARED_END
#endif
