/* The BSDFs' functions in the frame (x, y, z), LANES records a work-item. Their parameters come
   with the records, no scene is needed but for the tables of rough plastics. */

#include "probes/probe_values.clh"

#include "bsdf.clh"

/* material: kind with its flags, BSDF_PARAMETERS of three numbers each. in: wi, wo, u_lobe, u1, u2.
   out: the value at wo and the density there; a sampled direction, its weight, density and eta. */
__kernel void probe_bsdf(__global const clr_real *tables, __global const clr_real *material,
                         __global const clr_real *in, __global clr_real *out, uint count) {
    const uint first = (uint)get_global_id(0) * LANES, size = 9u, width = 12u;
    Bsdf bsdf;
    bsdf.flags = as_uint_l(to_int_l(real_of(material[0])));
    bsdf.kind = bsdf.flags & CLR_BSDF_KIND_MASK;
    bsdf.color = bsdf.color2 = bsdf.eta = bsdf.k = v3_of(0.0f, 0.0f, 0.0f);
#if HAS_ROUGHPLASTIC
    bsdf.tables = tables;
#else
    (void)tables;
#endif
    for (uint i = 0; i < BSDF_PARAMETERS; ++i)
        bsdf.parameter[i] =
            v3_of(material[3u * i + 1u], material[3u * i + 2u], material[3u * i + 3u]);
    const vec3 wi = probe_in3(in, first, count, size, 0u);
    const vec3 wo = probe_in3(in, first, count, size, 3u);
    ShadingFrame frame;
    frame.s = v3_of(1.0f, 0.0f, 0.0f);
    frame.t = v3_of(0.0f, 1.0f, 0.0f);
    frame.n = v3(real_of(0.0f), real_of(0.0f), copysign(real_of(1.0f), wi.z));
    frame.cos_i = fabs(wi.z);
    frame.back = lt(wi.z, real_of(0.0f));

    const BsdfValue v = bsdf_eval_pdf(bsdf, frame, wi, wo, all_lanes());
    probe_out3(v3_scale(v.color, v.factor), out, first, count, width, 0u);
    probe_out(v.pdf, out, first, count, width, 3u);
    const real u_lobe = probe_in(in, first, count, size, 6u);
    const real u1 = probe_in(in, first, count, size, 7u);
    const real u2 = probe_in(in, first, count, size, 8u);
    const BsdfSample s = bsdf_sample(bsdf, frame, wi, u_lobe, u1, u2, all_lanes());
    probe_out3(s.wo, out, first, count, width, 4u);
    probe_out3(s.weight, out, first, count, width, 7u);
    probe_out(s.pdf, out, first, count, width, 10u);
    probe_out(s.eta, out, first, count, width, 11u);
}
