#ifndef CLR_CONTROL_TILE_H
#define CLR_CONTROL_TILE_H
/* Some tiles of a picture are rendered a second time, as control: with as many samples, scrambled
   in another way. The difference of both tells how far the samples of a pixel are from independent
   ones, whose error their scatter would tell. */

#include "shared/launch_data.h"

CLR_SHARED_BEGIN

/* Sums over those samples of a control tile that reach a pixel of it, exact as FilmPixel's and in
   its units: `difference` of w times the distance from the value of each block's first sample,
   those of the second rendering taken off; and the `scatter` of both. */
#define CLR_DIFFERENCE_WORDS 4
#define CLR_DIFFERENCE_LSB (-76)
typedef struct {
    uint difference[CLR_DIFFERENCE_WORDS][4];
    uint scatter[CLR_SCATTER_WORDS][4];
} ControlPixel;
CLR_STATIC_SIZE(ControlPixel, 144);

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
