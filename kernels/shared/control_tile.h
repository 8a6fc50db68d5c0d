#ifndef CLR_CONTROL_TILE_H
#define CLR_CONTROL_TILE_H
/* Some tiles of a picture are rendered a second time, as control: with as many samples, scrambled
   in another way. The difference of both tells how far the samples of a pixel are from independent
   ones, whose error their scatter would tell. */

#include "shared/launch_data.h"

CLR_SHARED_BEGIN

/* Of both renderings, over those samples of a control tile that reach a pixel of it. */
typedef struct {
    MeasuredPixel rendering[2];
} ControlPixel;
CLR_STATIC_SIZE(ControlPixel, 480);

/* The tiles [group * size, (group + 1) * size) have one control tile: this. */
CLR_SHARED_INLINE uint clr_control_tile(uint group, uint size, uint tiles) {
    const uint first = group * size;
    const uint count = tiles - first < size ? tiles - first : size;
    uint x = group + 0x9e3779b9u;
    x = (x ^ x >> 16u) * 0x21f0aaadu;
    x = (x ^ x >> 15u) * 0xd35a2d97u;
    return first + (x ^ x >> 15u) % count;
}

CLR_SHARED_END
#endif
