/* The numbers of many samples of many pixels, for tests of their order. One batch of LANES values a
   work-item. */

#include "probes/probe_values.clh"
#include "sampler.clh"

/* Of pixel `pixel` + i / `samples` and sample `offset` + i % `samples`. */
CLR_INLINE Sampler probe_sampler_of(uint first, uint pixel, uint offset, uint samples) {
    uint_l index = lane_index() + first;
    return sampler_init(1u, index / samples + pixel, index % samples + offset);
}

/* out: the two numbers that `get` makes of `dimension`, of each. */
#define PROBE_SAMPLER(name, get)                                                                   \
    __kernel void name(__global clr_real *out, uint pixel, uint offset, uint samples,              \
                       uint dimension, uint count) {                                               \
        const uint first = (uint)get_global_id(0) * LANES;                                         \
        real u, v;                                                                                 \
        get(probe_sampler_of(first, pixel, offset, samples), dimension, &u, &v);                   \
        probe_out(u, out, first, count, 2u, 0u);                                                   \
        probe_out(v, out, first, count, 2u, 1u);                                                   \
    }

PROBE_SAMPLER(probe_sampler_pair, sampler_get_pair)
PROBE_SAMPLER(probe_sampler_two, sampler_get_two)
