/* The functions of math.clh, LANES records a work-item. */

#include "probes/probe_values.clh"

#include "math.clh"

/* in: an argument of each function. out: exp_of, log_of, scaled_erfc, inverse_erf. */
__kernel void probe_functions(__global const clr_real *in, __global clr_real *out, uint count) {
    const uint first = (uint)get_global_id(0) * LANES, size = 4u;
    probe_out(exp_of(probe_in(in, first, count, size, 0u)), out, first, count, size, 0u);
    probe_out(log_of(probe_in(in, first, count, size, 1u)), out, first, count, size, 1u);
    probe_out(scaled_erfc(probe_in(in, first, count, size, 2u)), out, first, count, size, 2u);
    probe_out(inverse_erf(probe_in(in, first, count, size, 3u)), out, first, count, size, 3u);
}
