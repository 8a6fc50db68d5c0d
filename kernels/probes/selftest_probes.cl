/* The device functions that the self-test compares with double precision, one program for all of
   them: LANES records of reals a work-item, `in` and `out` each of a fixed size a record. The
   program is compiled for everything that these functions can do. */

#include "probes/probe_values.clh"

#include "camera.clh"
#include "environment.clh"
#include "film.clh"
#include "light.clh"
#include "planar.clh"
#include "sampler.clh"
#include "sampling.clh"
#include "sphere.clh"
#include "texture.clh"

/* Records that share what is the same for all lanes: a shape, or a sampler's seed and dimension. */
#define PROBE_GROUP 16u

#define PROBE_SCENE_PARAMETERS                                                                     \
    SCENE_PARAMETERS, __global const clr_real *in, __global clr_real *out, uint count

#define PROBE_SCENE                                                                                \
    const uint first = (uint)get_global_id(0) * LANES;                                             \
    if (first >= count)                                                                            \
        return;                                                                                    \
    const SceneData data = SCENE_DATA;                                                             \
    const SceneData *scene = &data

#define PROBE_FIRST                                                                                \
    const uint first = (uint)get_global_id(0) * LANES;                                             \
    if (first >= count)                                                                            \
    return

/* in: turn; y, x; squares of distance and radius; unit vector n; densities a, b; u1, u2. out: sine
   and cosine of the turn; turn of (x, y); cap; the two vectors of the frame; mis_weight(a, b);
   mis_weight_over_pdf(a, b); sample_cosine about n and its cosine. */
__kernel void probe_math(__global const clr_real *in, __global clr_real *out, uint count) {
    PROBE_FIRST;
    const uint size = 12u, width = 16u;
    real sine, cosine;
    sincos_turn(probe_in(in, first, count, size, 0u), &sine, &cosine);
    probe_out(sine, out, first, count, width, 0u);
    probe_out(cosine, out, first, count, width, 1u);
    probe_out(turn_of(probe_in(in, first, count, size, 1u), probe_in(in, first, count, size, 2u)),
              out, first, count, width, 2u);
    const real distance2 = probe_in(in, first, count, size, 3u);
    probe_out(sphere_cap(distance2, sqrt(distance2), probe_in(in, first, count, size, 4u)), out,
              first, count, width, 3u);
    const vec3 n = probe_in3(in, first, count, size, 5u);
    vec3 s, t;
    make_frame(n, &s, &t);
    probe_out3(s, out, first, count, width, 4u);
    probe_out3(t, out, first, count, width, 7u);
    const real a = probe_in(in, first, count, size, 8u), b = probe_in(in, first, count, size, 9u);
    probe_out(mis_weight(a, b), out, first, count, width, 10u);
    probe_out(mis_weight_over_pdf(a, b), out, first, count, width, 11u);
    real cosine_n;
    probe_out3(sample_cosine(n, probe_in(in, first, count, size, 10u),
                             probe_in(in, first, count, size, 11u), &cosine_n),
               out, first, count, width, 12u);
    probe_out(cosine_n, out, first, count, width, 15u);
}

/* A sphere for each group of rays. in: o, d, t_max, 1 if the ray starts on the sphere. out: the
   distance by sphere_intersect and by sphere_root_bits, INFINITY for none before t_max; what
   sphere_blocks and sphere_blocks_opaque say. */
__kernel void probe_sphere(__global const SphereTest *spheres, uint large,
                           __global const clr_real *in, __global clr_real *out, uint count) {
    PROBE_FIRST;
    __global const SphereTest *s = spheres + first / PROBE_GROUP;
    const vec3 o = probe_in3(in, first, count, 8u, 0u), d = probe_in3(in, first, count, 8u, 3u);
    const real t_max = probe_in(in, first, count, 8u, 6u);
    const mask_l self = gt(probe_in(in, first, count, 8u, 7u), real_of(0.5f));
    real t;
    const mask_l met = sphere_intersect(s, o, d, self, t_max, &t);
    probe_out(pick(met, t, real_of(INFINITY)), out, first, count, 4u, 0u);
    const bits_l far = as_bits_l(t_max);
    const bits_l bits = min(sphere_root_bits(s, (int)large, o, d), far);
    probe_out(pick(same_bits(bits, far), real_of(INFINITY), as_real(bits)), out, first, count, 4u,
              1u);
    probe_out(probe_flag(sphere_blocks(s, o, d, self, t_max)), out, first, count, 4u, 2u);
    probe_out(probe_flag(sphere_blocks_opaque(s, (int)large, o, d, t_max)), out, first, count, 4u,
              3u);
}

#if HUGE_COUNT > 0
/* A huge sphere, its two entries together, for each group of rays. in: as above. out: the distance
   by sphere_intersect_huge, INFINITY for none before t_max. */
__kernel void probe_sphere_huge(__global const SphereTest *spheres, __global const clr_real *in,
                                __global clr_real *out, uint count) {
    PROBE_FIRST;
    __global const SphereTest *s = spheres + 2u * (first / PROBE_GROUP);
    const vec3 o = probe_in3(in, first, count, 8u, 0u), d = probe_in3(in, first, count, 8u, 3u);
    const mask_l self = gt(probe_in(in, first, count, 8u, 7u), real_of(0.5f));
    real t;
    const mask_l met = sphere_intersect_huge(s, o, d, self, probe_in(in, first, count, 8u, 6u), &t);
    probe_out(pick(met, t, real_of(INFINITY)), out, first, count, 1u, 0u);
}
#endif

/* A planar for each group of rays. in: o, d. out: the distance. `axis` is that of rectangles across
   a coordinate axis, 3 for none. */
__kernel void probe_planar(__global const Planar *planars, uint axis, __global const clr_real *in,
                           __global clr_real *out, uint count) {
    PROBE_FIRST;
    __global const Planar *p = planars + first / PROBE_GROUP;
    const vec3 o = probe_in3(in, first, count, 6u, 0u), d = probe_in3(in, first, count, 6u, 3u);
    real t;
    if (axis < 3u)
        t = planar_intersect_across(p, (int)axis, o, d, v3_inverse(d));
    else
        t = planar_intersect(p, o, d);
    probe_out(t, out, first, count, 1u, 0u);
}

/* in: column, row and sample of a camera ray. out: o, d, near, far, dx, dy and the pair of numbers
   for the lens. */
__kernel void probe_camera(PROBE_SCENE_PARAMETERS) {
    PROBE_SCENE;
    const int_l px = to_int_l(probe_in(in, first, count, 3u, 0u));
    const int_l py = to_int_l(probe_in(in, first, count, 3u, 1u));
    const uint_l sample = as_uint_l(to_int_l(probe_in(in, first, count, 3u, 2u)));
    const Sampler sampler = sampler_init(1u, as_uint_l(px + (py << 12)), sample);
    const CameraRay ray = camera_ray(scene, px, py, sampler);
    real u, v;
    sampler_get_pair(sampler, CAMERA_LENS, &u, &v);
    probe_out3(ray.o, out, first, count, 12u, 0u);
    probe_out3(ray.d, out, first, count, 12u, 3u);
    probe_out(ray.t_near, out, first, count, 12u, 6u);
    probe_out(ray.t_far, out, first, count, 12u, 7u);
    probe_out(ray.dx, out, first, count, 12u, 8u);
    probe_out(ray.dy, out, first, count, 12u, 9u);
    probe_out(u, out, first, count, 12u, 10u);
    probe_out(v, out, first, count, 12u, 11u);
}

/* in: u1, u2. out: a sampled direction, its radiance and density. */
__kernel void probe_env_sample(PROBE_SCENE_PARAMETERS) {
    PROBE_SCENE;
    vec3 direction;
    real pdf;
    const vec3 radiance =
        env_sample(scene, probe_in(in, first, count, 2u, 0u), probe_in(in, first, count, 2u, 1u),
                   all_lanes(), &direction, &pdf);
    probe_out3(direction, out, first, count, 7u, 0u);
    probe_out3(radiance, out, first, count, 7u, 3u);
    probe_out(pdf, out, first, count, 7u, 6u);
}

/* in: a direction. out: radiance and density there. */
__kernel void probe_env_eval(PROBE_SCENE_PARAMETERS) {
    PROBE_SCENE;
    real pdf;
    const vec3 radiance = env_eval(scene, probe_in3(in, first, count, 3u, 0u), &pdf);
    probe_out3(radiance, out, first, count, 4u, 0u);
    probe_out(pdf, out, first, count, 4u, 3u);
}

/* in: u, v and the number of a texture. out: its colour. */
__kernel void probe_texture(PROBE_SCENE_PARAMETERS) {
    PROBE_SCENE;
    const uint_l texture = as_uint_l(to_int_l(probe_in(in, first, count, 3u, 2u)));
    Surface at;
    at.u = probe_in(in, first, count, 3u, 0u);
    at.v = probe_in(in, first, count, 3u, 1u);
#if HAS_ATTRIBUTES
    at.mesh_point = mesh_point_none();
#endif
    probe_out3(texture_apply(scene, texture, TEXTURE_AT(at), all_lanes(), v3_of(0.0f, 0.0f, 0.0f)),
               out, first, count, 3u, 0u);
}

/* in: a direction from the centre of shape 0. out: u and v there. */
__kernel void probe_sphere_uv(PROBE_SCENE_PARAMETERS) {
    PROBE_SCENE;
    vec3 axis[3];
    sphere_axes(scene, int_of(0), axis);
    real u, v;
    sphere_uv(axis, probe_in3(in, first, count, 3u, 0u), &u, &v);
    probe_out(u, out, first, count, 2u, 0u);
    probe_out(v, out, first, count, 2u, 1u);
}

#if FILTER == CLR_FILTER_SPLATTED
/* in: the place within a pixel along an axis. out: the weights of the pixels around it. */
__kernel void probe_filter(PROBE_SCENE_PARAMETERS) {
    PROBE_SCENE;
    const uint weights = 2u * BORDER + 1u;
    for (uint i = 0; i < LANES && first + i < count; ++i) {
        float weight[2 * BORDER + 1];
        filter_weights(scene, (float)in[first + i], weight);
        for (uint k = 0; k < weights; ++k)
            out[weights * (first + i) + k] = weight[k];
    }
}
#elif FILTER == CLR_FILTER_SAMPLED
/* in: a number, and how many pixels the picture has on either side. out: the offset from the
   pixel's centre and the weight. */
__kernel void probe_filter_offset(PROBE_SCENE_PARAMETERS) {
    PROBE_SCENE;
    real weight = real_of(1.0f);
    const real x = filter_offset(scene, probe_in(in, first, count, 3u, 0u),
                                 to_int_l(probe_in(in, first, count, 3u, 1u)),
                                 to_int_l(probe_in(in, first, count, 3u, 2u)), &weight);
    probe_out(x, out, first, count, 2u, 0u);
    probe_out(weight, out, first, count, 2u, 1u);
}
#endif

CLR_INLINE void probe_out_light(LightSample s, __global clr_real *out, uint first, uint count) {
    probe_out3(s.wi, out, first, count, 10u, 0u);
    probe_out(s.t_max, out, first, count, 10u, 3u);
    probe_out3(s.radiance, out, first, count, 10u, 4u);
    probe_out(s.inv_pdf, out, first, count, 10u, 7u);
    probe_out(probe_flag(s.valid), out, first, count, 10u, 8u);
    probe_out(probe_flag(s.delta), out, first, count, 10u, 9u);
}

/* in: a point, the number of a light, u1, u2. out: the sample of that light: direction, distance,
   radiance, inverse density, whether it is valid and of a point light. */
__kernel void probe_light_local(PROBE_SCENE_PARAMETERS) {
    PROBE_SCENE;
    LightSample s;
    s.wi = s.radiance = v3_of(0.0f, 0.0f, 0.0f);
    s.t_max = real_of(0.0f);
    s.inv_pdf = real_of(1.0f);
    s.prim = int_of(-1);
    s.delta = no_lanes();
    s.valid = all_lanes();
    light_sample_local(
        scene, probe_in3(in, first, count, 6u, 0u), to_int_l(probe_in(in, first, count, 6u, 3u)),
        probe_in(in, first, count, 6u, 4u), probe_in(in, first, count, 6u, 5u), all_lanes(), &s);
    probe_out_light(s, out, first, count);
}

/* in: a point, its normal, three numbers. out: as above, of any light. */
__kernel void probe_light_sample(PROBE_SCENE_PARAMETERS) {
    PROBE_SCENE;
    BounceNumbers numbers;
    numbers.light = probe_in(in, first, count, 9u, 6u);
    numbers.light_u = probe_in(in, first, count, 9u, 7u);
    numbers.light_v = probe_in(in, first, count, 9u, 8u);
    numbers.lobe = numbers.bsdf_u = numbers.bsdf_v = real_of(0.0f);
    const uint_l item = lane_index() + first;
    probe_out_light(light_sample(scene, probe_in3(in, first, count, 9u, 0u),
                                 probe_in3(in, first, count, 9u, 3u), numbers,
                                 sampler_init(1u, item, item), all_lanes()),
                    out, first, count);
}

/* in: a point, its normal, a direction, the emitter met there, its primitive, its normal and the
   distance. out: radiance and density. */
__kernel void probe_light_eval(PROBE_SCENE_PARAMETERS) {
    PROBE_SCENE;
    const uint size = 15u;
    Surface surface;
    surface.ng = surface.ns = probe_in3(in, first, count, size, 11u);
    surface.u = surface.v = real_of(0.0f);
    surface.emitter = to_int_l(probe_in(in, first, count, size, 9u));
    real pdf;
    const vec3 radiance = light_of_surface(
        scene, surface, to_int_l(probe_in(in, first, count, size, 10u)),
        probe_in3(in, first, count, size, 0u), probe_in3(in, first, count, size, 3u),
        probe_in3(in, first, count, size, 6u), probe_in(in, first, count, size, 14u), all_lanes(),
        &pdf);
    probe_out3(radiance, out, first, count, 4u, 0u);
    probe_out(pdf, out, first, count, 4u, 3u);
}

/* A seed and a dimension for each group. in: pixel and sample. out: the number, the two of one hash
   and the pair. */
__kernel void probe_numbers(__global const uint *groups, __global const uint *in,
                            __global clr_real *out, uint count) {
    PROBE_FIRST;
    uint pixel[LANES], sample[LANES];
    for (uint i = 0; i < LANES; ++i) {
        pixel[i] = in[2u * min(first + i, count - 1u)];
        sample[i] = in[2u * min(first + i, count - 1u) + 1u];
    }
    const uint seed = groups[2u * (first / PROBE_GROUP)];
    const uint dimension = groups[2u * (first / PROBE_GROUP) + 1u];
    const Sampler s = sampler_init(seed, load_uint(pixel), load_uint(sample));
    real u, v;
    probe_out(sampler_get(s, dimension), out, first, count, 5u, 0u);
    sampler_get_two(s, dimension, &u, &v);
    probe_out(u, out, first, count, 5u, 1u);
    probe_out(v, out, first, count, 5u, 2u);
    sampler_get_pair(s, dimension, &u, &v);
    probe_out(u, out, first, count, 5u, 3u);
    probe_out(v, out, first, count, 5u, 4u);
}
