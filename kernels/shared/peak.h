#ifndef CLR_PEAK_H
#define CLR_PEAK_H

/* Independent sums of kernels/peak.cl: enough to hide what one fma takes, few enough for all to
   stay in registers. */
#define CLR_PEAK_CHAINS 10
/* fma of a round, on all lanes. */
#define CLR_PEAK_FMAS (4 * CLR_PEAK_CHAINS)

#endif
