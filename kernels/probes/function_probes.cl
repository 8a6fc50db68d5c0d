/* Runs small device functions alone, for tests. One batch of LANES values a work-item, at any
   width. Reads `in`, writes what its name says to `out`. */

#include "sampler.clh"
#include "sampling.clh"

/* out: sine and cosine of 2 pi in, one after the other. */
__kernel void probe_sincos(__global const float *in, __global float *out, uint count) {
    const uint first = (uint)get_global_id(0) * LANES;
    float u[LANES], sine[LANES], cosine[LANES];
    for (uint i = 0; i < LANES; ++i)
        u[i] = first + i < count ? in[first + i] : 0.0f;
    real s, c;
    sincos_turn(load_real(u), &s, &c);
    store_real(s, sine);
    store_real(c, cosine);
    for (uint i = 0; i < LANES && first + i < count; ++i) {
        out[2u * (first + i)] = sine[i];
        out[2u * (first + i) + 1u] = cosine[i];
    }
}

/* in: vectors, y before x; out: the turn of each. */
__kernel void probe_turn(__global const float *in, __global float *out, uint count) {
    const uint first = (uint)get_global_id(0) * LANES;
    float y[LANES], x[LANES], turn[LANES];
    for (uint i = 0; i < LANES; ++i) {
        const uint at = min(first + i, count - 1u);
        y[i] = in[2u * at];
        x[i] = in[2u * at + 1u];
    }
    store_real(turn_of(load_real(y), load_real(x)), turn);
    for (uint i = 0; i < LANES && first + i < count; ++i)
        out[first + i] = turn[i];
}

/* out: number `dimension` of pixel i and sample i + `offset`. */
__kernel void probe_sampler(__global float *out, uint seed, uint offset, uint dimension,
                            uint count) {
    const uint first = (uint)get_global_id(0) * LANES;
    uint pixel[LANES], sample[LANES];
    float value[LANES];
    for (uint i = 0; i < LANES; ++i) {
        pixel[i] = first + i;
        sample[i] = first + i + offset;
    }
    Sampler sampler = sampler_init(seed, load_uint(pixel), load_uint(sample));
    store_real(sampler_get(sampler, dimension), value);
    for (uint i = 0; i < LANES && first + i < count; ++i)
        out[first + i] = value[i];
}

/* in: unit vectors n, three floats each; out: the two vectors that complete each. */
__kernel void probe_frame(__global const float *in, __global float *out, uint count) {
    const uint first = (uint)get_global_id(0) * LANES;
    float x[LANES], y[LANES], z[LANES];
    for (uint i = 0; i < LANES; ++i) {
        const uint at = min(first + i, count - 1u);
        x[i] = in[3u * at];
        y[i] = in[3u * at + 1u];
        z[i] = in[3u * at + 2u];
    }
    vec3 s, t;
    make_frame(v3(load_real(x), load_real(y), load_real(z)), &s, &t);
    real part[6] = {s.x, s.y, s.z, t.x, t.y, t.z};
    for (uint k = 0; k < 6u; ++k) {
        float value[LANES];
        store_real(part[k], value);
        for (uint i = 0; i < LANES && first + i < count; ++i)
            out[6u * (first + i) + k] = value[i];
    }
}

/* out: the pair `dimension` of pixel `pixel` + i / `samples` and sample `offset` + i % `samples`,
   two floats each. */
__kernel void probe_sampler_pair(__global float *out, uint pixel, uint offset, uint samples,
                                 uint dimension, uint count) {
    const uint first = (uint)get_global_id(0) * LANES;
    uint pixels[LANES], sample[LANES];
    float us[LANES], vs[LANES];
    for (uint i = 0; i < LANES; ++i) {
        pixels[i] = pixel + (first + i) / samples;
        sample[i] = offset + (first + i) % samples;
    }
    Sampler sampler = sampler_init(1u, load_uint(pixels), load_uint(sample));
    real u, v;
    sampler_get_pair(sampler, dimension, &u, &v);
    store_real(u, us);
    store_real(v, vs);
    for (uint i = 0; i < LANES && first + i < count; ++i) {
        out[2u * (first + i)] = us[i];
        out[2u * (first + i) + 1u] = vs[i];
    }
}
