#ifndef CLR_FILM_FILTER_H
#define CLR_FILM_FILTER_H
/* Layout of the reconstruction filter's table, one axis of the separable filter, in floats:
   the inverse of the cumulative |filter| at i / CLR_FILTER_STEPS (pixels from the centre), the sign
   of the filter in each step, and, for k = 0, 1, ..., the share of |filter| and of the filter that
   lies beyond k + 1/2 pixels on one side (0 where the filter ends before). */

#define CLR_FILTER_STEPS 2048
#define CLR_FILTER_EDGES 64
#define CLR_FILTER_INVERSE 0
#define CLR_FILTER_SIGN (CLR_FILTER_INVERSE + CLR_FILTER_STEPS + 1)
#define CLR_FILTER_EDGE (CLR_FILTER_SIGN + CLR_FILTER_STEPS)
#define CLR_FILTER_EDGE_SIGNED (CLR_FILTER_EDGE + CLR_FILTER_EDGES)
#define CLR_FILTER_NORM (CLR_FILTER_EDGE_SIGNED + CLR_FILTER_EDGES)
#define CLR_FILTER_SIZE (CLR_FILTER_NORM + 1)

#endif
