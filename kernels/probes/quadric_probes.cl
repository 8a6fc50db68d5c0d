/* Rays before quadrics, what they find there, and light samples of them: for tests. */

#include "probes/probe_values.clh"

#include "bvh.clh"
#include "light.clh"
#include "quadric.clh"
#include "surface.clh"

#if HAS_QUADRIC_LIGHTS

#define PROBE_IN 9u
#define PROBE_OUT 16u

/* Each record has a quadric and a block of its own. in: origin, direction of length 1, whether the
   ray starts on the quadric, u1, u2. out: t, INFINITY for none; point, normal, u, v there; of a
   light's sample from the origin its direction, t_max, the inverse density and whether it is valid;
   and the density with which light sampling takes the ray's direction. */
__kernel void probe_quadrics(__global const Quadric *quadrics, __global const QuadricBlock *blocks,
                             __global const clr_real *in, __global clr_real *out, uint count) {
    const uint first = (uint)get_global_id(0) * LANES;
    if (first >= count)
        return;
    const vec3 o = probe_in3(in, first, count, PROBE_IN, 0u);
    const vec3 d = probe_in3(in, first, count, PROBE_IN, 3u);
    clr_real t[LANES];
    int index[LANES];
    for (uint i = 0u; i < LANES; ++i) {
        const uint record = min(first + i, count - 1u);
        index[i] = (int)record;
        const int on_self = in[PROBE_IN * record + 6u] > 0.5f;
        BvhRay ray;
        ray.o = vload3(0, in + PROBE_IN * record);
        ray.d = vload3(0, in + PROBE_IN * record + 3u);
        ray.self = on_self ? (uint)blocks[record].prim[0] : BVH_NO_PRIM;
        BvhHit hit = {INFINITY, 0.0f, 0.0f, BVH_NO_PRIM, 0u};
        const int met = bvh_visit_quadrics(blocks + record, &ray, &hit);
        ray.light = BVH_NO_PRIM;
        t[i] = met == bvh_meets_quadrics(blocks + record, &ray, INFINITY) ? hit.t : NAN;
    }
    const QuadricMap q = quadric_map(quadrics, load_int(index));
    const real at = load_real(t);
    vec3 own, n;
    const vec3 p = quadric_point(q, v3_mad(d, at, o), &own, &n);
    real u, v;
    quadric_uv(q, own, &u, &v);
    probe_out(at, out, first, count, PROBE_OUT, 0u);
    probe_out3(p, out, first, count, PROBE_OUT, 1u);
    probe_out3(n, out, first, count, PROBE_OUT, 4u);
    probe_out(u, out, first, count, PROBE_OUT, 7u);
    probe_out(v, out, first, count, PROBE_OUT, 8u);
    probe_out(light_pdf_quadric(q, n, o, d, at), out, first, count, PROBE_OUT, 15u);

    LightSample s = light_sample_none(all_lanes());
    light_sample_quadric(q, int_of(0), o, probe_in(in, first, count, PROBE_IN, 7u),
                         probe_in(in, first, count, PROBE_IN, 8u), all_lanes(), &u, &v, &s);
    probe_out3(s.wi, out, first, count, PROBE_OUT, 9u);
    probe_out(s.t_max, out, first, count, PROBE_OUT, 12u);
    probe_out(s.inv_pdf, out, first, count, PROBE_OUT, 13u);
    probe_out(probe_flag(s.valid), out, first, count, PROBE_OUT, 14u);
}

#endif
