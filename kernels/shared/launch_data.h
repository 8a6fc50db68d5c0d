#ifndef CLR_LAUNCH_DATA_H
#define CLR_LAUNCH_DATA_H
/* What changes from launch to launch, and what a launch gives back. */

#include "shared/shared_types.h"

CLR_PRECISION_BEGIN

/* The samples of a pixel are summed in blocks, each from zero and in an order that depends on
   nothing but the scene and the width of the kernel; block b begins with sample CLR_BLOCK_START(b),
   whatever the total: at 0, 16, 32, 64, and from there on every 64. Blocks are added as integers,
   so neither the launches nor their order change a picture, and a picture of N samples is the first
   N samples of any longer one, where a block ends at N. */
#define CLR_BLOCK_START(b) ((b) < 3 ? (b)*16 : ((b)-2) * 64)

/* The camera, the environment and the bounds of the loop. All directions are in world axes.
   A pixel position (x, y), in pixels from the corner of the whole film, looks along
   corner + x step_x + y step_y, whose component along the axis is 1. */
typedef struct {
    clr_real start[3];  /* the film's corner at the depth where camera rays start */
    clr_real near_clip; /* along the axis, from the start */
    clr_real corner[3];
    clr_real far_clip; /* likewise; INFINITY where the scene states none */
    clr_real step_x[3];
    clr_real aperture_radius;
    clr_real step_y[3];
    clr_real focus_distance;
    clr_real axis[3];
    clr_real length_unit; /* scene units per renderer's unit, for the depth integrator */
    clr_real lens_x[3];
    clr_real env_alpha; /* of camera rays that leave the scene */
    clr_real lens_y[3];
    clr_real shadow_free_distance; /* from the only light, the first SHADOW_FREE_COUNT spheres
                                   cannot come between it and a point that is nearer */
    clr_real env_radiance[3];      /* of a constant environment */
    clr_real env_probability;      /* that light sampling chooses the environment */
    clr_real env_rotation[12];     /* rows of world-to-environment, each followed by 0 */
    uint env_width;                /* pixels of the map */
    uint env_height;
    clr_real env_density; /* of light sampling, per solid angle: this times the weight of the place,
                          times the sines of the row's middle over that of the place */
    int max_depth;        /* edges of the longest path; INT_MAX: unbounded */
    int rr_depth;         /* roulette at every vertex from this depth on; INT_MAX: never */
    uint width;           /* of the picture (the crop window), pixels */
    uint height;
    int crop_x; /* of the crop window within the whole film */
    int crop_y;
    uint seed;
    uint prim_bvh_sphere;   /* first primitive that is a sphere in the BVH */
    uint total_samples;     /* a pixel, over all launches */
    clr_real filter_radius; /* pixels */
    uint triangle_blocks;   /* in the BVH's leaves */
    uint sphere_blocks;
    clr_real final_distance2; /* FINAL_BY_LIGHTS: the square of a distance from which the only light
                              looks small */
    int film_exponent;        /* the film's unit of colour is 2^film_exponent */
    uint control_group;       /* tiles of which one is a control tile; 0: there are none */
    uint prim_quadric;        /* first primitive that is a quadric */
    uint quadric_blocks;      /* in the BVH's leaves */
    int window_depth;         /* roulette as a weight window, from this depth on */
    uint pad2;
    clr_real planar_rim; /* hits of planars up to these |a|, |b| or radius are not at the outline */
    clr_real lens_share; /* of the offset on the lens that is left at the start of a ray */
    clr_real skipped_depth; /* from the near clip plane to the start, where that is farther away */
    clr_real first_leg;     /* FAR_CAMERA: depth of the start, from the near clip plane */
    clr_real start_x[3];    /* a pixel's width there */
    clr_real pad0;
    clr_real start_y[3];
    clr_real pad1;
} FrameData;
CLR_STATIC_SIZE(FrameData, CLR_EITHER(312, 552));

CLR_PRECISION_END

CLR_SHARED_BEGIN

/* Sums over the samples of a pixel, exact: the value of each block of samples is cut off to a
   multiple of a power of two, once, and added as an integer in two's complement, the lowest word
   first. So sums over parts of the samples, of the picture or of the devices add up to the same
   bits in any order.

   `colour`: of w R, w G, w B, w alpha over the samples that reach the pixel, w being the filter's
   weight. The lowest bit is worth 2^CLR_COLOUR_LSB units (FrameData::film_exponent; of alpha: 1).
   `weight`: of w, of 64 bits, the lowest worth 2^CLR_WEIGHT_LSB. `samples`: that lie in the pixel.
   `clamped`: blocks with a value beyond CLR_FILM_LIMIT (in units of the highest word), which is put
   in its place: 2^28 blocks of that size do not overflow. */
#define CLR_COLOUR_WORDS 4
#define CLR_COLOUR_LSB (-76)
#define CLR_WEIGHT_LSB (-30)
#define CLR_FILM_LIMIT 8
typedef struct {
    uint colour[CLR_COLOUR_WORDS][4];
    uint weight[2];
    uint samples;
    uint clamped;
} FilmPixel;
CLR_STATIC_SIZE(FilmPixel, 80);

/* What the variance of a pixel follows from, where it is wanted (VARIANCE): of the same samples,
   with L for R, G, B or alpha, the sums of w^2 L and w^2 L^2, in units and squared units, and of
   w^2, of 64 bits, the lowest worth 2^CLR_SQUARE_WEIGHT_LSB. The sum of w^2 (L - m)^2 follows for
   any m, such as the mean over tiles that do not know one another. It may be small against that of
   w^2 L^2: what a block adds to the three sums belongs to one float weight, mean and scatter, and
   the products of these are added without rounding (film_add_moments). */
#define CLR_FIRST_WORDS CLR_COLOUR_WORDS
#define CLR_FIRST_LSB CLR_COLOUR_LSB
#define CLR_SECOND_WORDS 5
#define CLR_SECOND_LSB (-96)
#define CLR_SQUARE_WEIGHT_LSB (-32)
typedef struct {
    uint first[CLR_FIRST_WORDS][4];
    uint second[CLR_SECOND_WORDS][4];
    uint weight[2];
    uint pad[2];
} FilmMoments;
CLR_STATIC_SIZE(FilmMoments, 160);

/* The film's pixels where the variance is wanted. */
typedef struct {
    FilmPixel sums;
    FilmMoments moments;
} MeasuredPixel;
CLR_STATIC_SIZE(MeasuredPixel, 240);

/* Tiles whose splats cannot meet have the same colour: even or odd column and row of the tile. */
#define CLR_TILE_COLOURS 4
#define CLR_ALL_TILES 4 /* "of every colour" */
/* The smallest tile that is used with splatting. */
#define CLR_LEAST_TILE 8

/* What one work-item counted, over all launches. */
typedef struct {
    uint rays_low;
    uint rays_high;
    uint nonfinite;       /* samples that were not finite, 2^32 - 1 at most; they count as black */
    uint first_nonfinite; /* pixel index of the first, valid where nonfinite > 0 */
} ItemCounters;
CLR_STATIC_SIZE(ItemCounters, 16);

CLR_SHARED_END
#endif
