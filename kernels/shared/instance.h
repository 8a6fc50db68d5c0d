#ifndef CLR_SHARED_INSTANCE_H
#define CLR_SHARED_INSTANCE_H
/* Copies of groups of triangles as the device reads them: a place for each, and one tree a group.
 */

#include "shared/shared_types.h"

CLR_PRECISION_BEGIN

/* From the renderer's coordinates to the group's, in which its triangles and its tree lie:
   p' = x p.x + y p.y + z p.z + origin. `root` is the tree's root among the nodes. `slack` bounds
   the coordinates that the map adds up for any point of the instance: what it loses to rounding is
   relative to them. */
typedef struct {
    clr_real x[3];
    clr_real slack;
    clr_real y[3];
    clr_word root;
    clr_real z[3];
    clr_word pad0;
    clr_real origin[3];
    clr_word pad1;
} Instance;
CLR_STATIC_WORDS(Instance, 16);

CLR_PRECISION_END
#endif
