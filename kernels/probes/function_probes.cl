/* Runs small device functions alone, for tests. One batch of LANES values a work-item, at any
   width. Reads `in`, writes what its name says to `out`. */

#include "sampler.clh"
#include "sampling.clh"

/* Number `k` of the records `first` and following, `size` floats each; the last of `count` repeats.
 */
CLR_INLINE real probe_in(__global const clr_real *in, uint first, uint count, uint size, uint k) {
    clr_real value[LANES];
    for (uint i = 0; i < LANES; ++i)
        value[i] = in[size * min(first + i, count - 1u) + k];
    return load_real(value);
}

CLR_INLINE void probe_out(real v, __global clr_real *out, uint first, uint count, uint size,
                          uint k) {
    clr_real value[LANES];
    store_real(v, value);
    for (uint i = 0; i < LANES && first + i < count; ++i)
        out[size * (first + i) + k] = value[i];
}

/* out: sine and cosine of 2 pi in, one after the other. */
__kernel void probe_sincos(__global const clr_real *in, __global clr_real *out, uint count) {
    const uint first = (uint)get_global_id(0) * LANES;
    real sine, cosine;
    sincos_turn(probe_in(in, first, count, 1u, 0u), &sine, &cosine);
    probe_out(sine, out, first, count, 2u, 0u);
    probe_out(cosine, out, first, count, 2u, 1u);
}

/* in: vectors, y before x; out: the turn of each. */
__kernel void probe_turn(__global const clr_real *in, __global clr_real *out, uint count) {
    const uint first = (uint)get_global_id(0) * LANES;
    real y = probe_in(in, first, count, 2u, 0u), x = probe_in(in, first, count, 2u, 1u);
    probe_out(turn_of(y, x), out, first, count, 1u, 0u);
}

/* in: squares of distance and radius; out: the cap that the sphere covers. */
__kernel void probe_sphere_cap(__global const clr_real *in, __global clr_real *out, uint count) {
    const uint first = (uint)get_global_id(0) * LANES;
    real distance2 = probe_in(in, first, count, 2u, 0u);
    real radius2 = probe_in(in, first, count, 2u, 1u);
    probe_out(sphere_cap(distance2, sqrt(distance2), radius2), out, first, count, 1u, 0u);
}

/* out: number `dimension` of pixel i and sample i + `offset`. */
__kernel void probe_sampler(__global clr_real *out, uint seed, uint offset, uint dimension,
                            uint count) {
    const uint first = (uint)get_global_id(0) * LANES;
    uint_l pixel = lane_index() + first;
    Sampler sampler = sampler_init(seed, pixel, pixel + offset);
    probe_out(sampler_get(sampler, dimension), out, first, count, 1u, 0u);
}

/* in: unit vectors n, three floats each; out: the two vectors that complete each. */
__kernel void probe_frame(__global const clr_real *in, __global clr_real *out, uint count) {
    const uint first = (uint)get_global_id(0) * LANES;
    vec3 s, t;
    make_frame(v3(probe_in(in, first, count, 3u, 0u), probe_in(in, first, count, 3u, 1u),
                  probe_in(in, first, count, 3u, 2u)),
               &s, &t);
    real part[6] = {s.x, s.y, s.z, t.x, t.y, t.z};
    for (uint k = 0; k < 6u; ++k)
        probe_out(part[k], out, first, count, 6u, k);
}

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
