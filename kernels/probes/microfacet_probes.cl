/* The microfacet distributions, LANES records a work-item. */

#include "probes/probe_values.clh"

#include "microfacet.clh"

/* in: wi, h, alpha_u, alpha_v, 1 for Beckmann or 0 for GGX, u1, u2. out: D(h), G1 of wi for h, the
   density of h as a normal visible from wi; a sampled normal and its density. */
__kernel void probe_microfacets(__global const clr_real *in, __global clr_real *out, uint count) {
    const uint first = (uint)get_global_id(0) * LANES, size = 11u, width = 7u;
    const vec3 wi = probe_in3(in, first, count, size, 0u),
               h = probe_in3(in, first, count, size, 3u);
    const Microfacets m =
        microfacets(probe_in(in, first, count, size, 6u), probe_in(in, first, count, size, 7u),
                    gt(probe_in(in, first, count, size, 8u), real_of(0.5f)));
    probe_out(microfacets_d(m, h), out, first, count, width, 0u);
    probe_out(microfacets_g1(m, wi, h), out, first, count, width, 1u);
    probe_out(microfacets_pdf(m, wi, h), out, first, count, width, 2u);
    const vec3 sampled = microfacets_sample(m, wi, probe_in(in, first, count, size, 9u),
                                            probe_in(in, first, count, size, 10u));
    probe_out3(sampled, out, first, count, width, 3u);
    probe_out(microfacets_pdf(m, wi, sampled), out, first, count, width, 6u);
}
