#ifndef CLR_FILM_FILTER_H
#define CLR_FILM_FILTER_H
/* Layout of the reconstruction filter's table, one axis of the separable filter, in floats:
   the filter itself, a step function of the distance from the centre with CLR_FILTER_LEVELS steps
   out to its radius, divided by its integral; a place in pixels for each of CLR_FILTER_STEPS + 1
   numbers in [0, 1], so that places come up in proportion to about |filter|; and, for k = 0, 1,
   ..., the share of the numbers, and of the filter's integral, that lie beyond k + 1/2 pixels on
   one side. */

#define CLR_FILTER_LEVELS 31
#define CLR_FILTER_STEPS 2048
#define CLR_FILTER_EDGES 64
#define CLR_FILTER_VALUES 0
#define CLR_FILTER_INVERSE (CLR_FILTER_VALUES + CLR_FILTER_LEVELS + 1)
#define CLR_FILTER_EDGE (CLR_FILTER_INVERSE + CLR_FILTER_STEPS + 1)
#define CLR_FILTER_EDGE_SIGNED (CLR_FILTER_EDGE + CLR_FILTER_EDGES)
#define CLR_FILTER_SIZE (CLR_FILTER_EDGE_SIGNED + CLR_FILTER_EDGES)

#endif
