/* The bounce loop.

   A work-item renders a tile of TILE x TILE pixels, block of samples by block of samples, LANES
   paths side by side. A lane whose path has ended takes the next sample of the block, so lanes stay
   full; only the end of a block runs with empty ones.

   Reads the scene, adds to the film and to the item's counters. Width: LANES. */

#include "lanes.clh"

#include "bsdf.clh"
#include "camera.clh"
#include "environment.clh"
#include "film.clh"
#include "light.clh"
#include "paths.clh"
#include "profile.clh"
#include "sampler.clh"
#include "scene.clh"
#include "shared/launch_data.h"
#include "surface.clh"

/* Bounces whose numbers are spread evenly over the samples of a pixel. */
#define ORDERED_BOUNCES 2

/* Turns the seed of a tile into that of its second rendering, where it is a control tile. */
#define CONTROL_SEED 0xa511e9b3u

/* Lanes that have to be idle before new samples are started. */
#define REFILL_LANES ((LANES + 3) / 4)

/* Whether lanes have stood idle for so many steps, all together, that new samples are due. Starting
   them costs the same for one lane as for all, about a step; and lanes that have started together
   need their ordered numbers, and meet their end, together, which is worth the more the longer
   their paths are: so the wait grows with the steps of the busy lanes. */
CLR_INLINE int refill_is_due(int idle_steps, int busy_steps) {
    return idle_steps >= LANES + busy_steps / 3;
}

CLR_INLINE void paths_add_radiance(Paths *p, vec3 radiance, real weight, mask_l on) {
    weight = pick(on, weight, real_of(0.0f));
    vec3 value = v3_mul(p->throughput, radiance);
    /* Lanes that are off may hold anything, so they are picked out and not multiplied by zero. */
    p->radiance.x = pick(on, fma(value.x, weight, p->radiance.x), p->radiance.x);
    p->radiance.y = pick(on, fma(value.y, weight, p->radiance.y), p->radiance.y);
    p->radiance.z = pick(on, fma(value.z, weight, p->radiance.z), p->radiance.z);
}

/* Weight of light that BSDF sampling has found, when light sampling has density `pdf` there. */
CLR_INLINE real weight_of_chance(const Paths *p, real pdf) {
#if STRATEGY == 0
    return mis_weight(p->prev_pdf, pdf);
#elif STRATEGY == 1
    return pick(lt(p->prev_pdf, real_of(INFINITY)), real_of(0.0f), real_of(1.0f));
#else
    return real_of(1.0f);
#endif
}

#if ENVIRONMENT
/* Light that escaping paths bring home. */
CLR_INLINE void paths_add_environment(const SceneData *scene, Paths *p, mask_l escaped) {
    __global const FrameData *f = scene->frame;
#if HIDE_EMITTERS
    escaped &= ~ieq(p->depth, int_of(0));
#endif
    if (!any_lane(escaped))
        return;
#if ENVIRONMENT == 2
    real pdf;
    vec3 radiance = env_eval(scene, p->d, &pdf);
    paths_add_radiance(p, radiance, weight_of_chance(p, pdf * f->env_probability), escaped);
#else
    vec3 radiance = v3_of(f->env_radiance[0], f->env_radiance[1], f->env_radiance[2]);
    paths_add_radiance(p, radiance, real_of(1.0f), escaped);
#endif
}
#endif

#if HAS_AREA_EMITTERS
/* Light of the surfaces that paths have met. */
CLR_INLINE void paths_add_emission(const SceneData *scene, Paths *p, Surface surface, int_l prim,
                                   real t, mask_l hit) {
    mask_l front = lt(v3_dot(surface.ns, p->d), real_of(0.0f));
    mask_l lit = hit & front & ige(surface.emitter, int_of(0));
    if (!any_lane(lit))
        return;
    real pdf;
    vec3 radiance = light_of_surface(scene, surface, prim, p->o, p->prev_n, p->d, t, lit, &pdf);
    paths_add_radiance(p, radiance, weight_of_chance(p, pdf), lit);
}
#endif

#if HAS_LIGHTS && HAS_DIFFUSE && STRATEGY != 2
/* Light of one sampled light each, behind a shadow ray, for paths whose throughput has taken in the
   albedo. In lanes of `final` the path ends here, and no ray follows that could find a light by
   chance; in lanes of `parted` this is one of LIGHT_SAMPLES. */
CLR_INLINE void paths_add_light(const SceneData *scene, Paths *p, vec3 o, vec3 n, int_l prim,
                                LightSample light, mask_l final, mask_l parted) {
    real cosine = v3_dot(n, light.wi);
    mask_l wanted = light.valid & gt(cosine, real_of(0.0f));
    if (!any_lane(wanted))
        return;
    p->rays += (uint)count_lanes(wanted);
    PROFILE_ADD(scene->counts, PROFILE_SHADOW_RAYS, count_lanes(wanted));
    PROFILE_ADD(scene->counts, PROFILE_SHADOW_STEPS, 1u);
    mask_l lit =
        wanted & ~scene_occluded(scene, o, light.wi, prim, light.prim, light.t_max, wanted);
    real bsdf_pdf = cosine * CLR_INV_PI;
    real share = pick(parted, real_of(1.0f / LIGHT_SAMPLES), real_of(1.0f));
#if STRATEGY == 0
    real weight = bsdf_pdf * mis_weight_over_pdf(light.inv_pdf, bsdf_pdf * share);
#if FINAL_BY_LIGHTS
    weight = pick(final, bsdf_pdf * light.inv_pdf, weight);
#else
    (void) final;
#endif
#if HAS_POINT_LIGHTS
    weight = pick(light.delta, bsdf_pdf * light.inv_pdf, weight);
#endif
#else
    real weight = bsdf_pdf * light.inv_pdf;
#endif
    paths_add_radiance(p, light.radiance, weight * share, lit);
}

/* Direct light at diffuse surfaces: `light` is what was sampled first. In lanes of `parted`, where
   paths first meet one, the noise of the whole path is mostly that of the light, and more of it is
   sampled. */
CLR_INLINE void paths_add_direct(const SceneData *scene, Paths *p, vec3 o, vec3 n, int_l prim,
                                 LightSample light, mask_l final, mask_l parted) {
    paths_add_light(scene, p, o, n, prim, light, final, parted);
    if (!any_lane(parted))
        return;
    for (uint part = 1u; part < LIGHT_SAMPLES; ++part) {
        BounceNumbers numbers;
        const Sampler sampler = sampler_of_part(p->sampler, part);
        sampler_get_light(sampler, &numbers);
        light = light_sample(scene, o, n, numbers, sampler, parted);
        paths_add_light(scene, p, o, n, prim, light, final, parted);
    }
}
#endif

/* Roulette: paths go on with the probability of their throughput, .95 at most. */
#if HAS_ROULETTE
CLR_INLINE void paths_roulette(const SceneData *scene, Paths *p) {
    mask_l late = p->alive & ige(p->depth, int_of(scene->frame->rr_depth));
    if (!any_lane(late))
        return;
    vec3 size = v3(fabs(p->throughput.x), fabs(p->throughput.y), fabs(p->throughput.z));
    real survival = min(v3_max(size) * p->eta2, real_of(CLR_REAL(0.95)));
    real u = sampler_get(p->sampler, BOUNCE_ROULETTE);
    p->throughput = v3_pick(late, v3_scale(p->throughput, 1.0f / survival), p->throughput);
    p->alive &= ~late | lt(u, survival);
}
#endif

/* Where a ray ends: only camera rays may be clipped. */
#if HAS_CLIP || FAR_CAMERA || INTEGRATOR == 1
#define CLIP_END(p) ((p)->t_max)
#else
#define CLIP_END(p) real_of(INFINITY)
#endif

#if INTEGRATOR != 1
/* What the paths in `met` take in at a surface before it scatters them. */
CLR_INLINE void paths_see(const SceneData *scene, Paths *p, Surface surface, Hit hit, mask_l met) {
#if HAS_ALPHA
    /* The camera's path has the filter's weight as its throughput until its first bounce. */
    mask_l seen = met & ieq(p->depth, int_of(0));
#if HAS_AREA_EMITTERS
    if (scene->frame->max_depth == 1)
        seen &= ige(surface.emitter, int_of(0)) & lt(v3_dot(surface.ns, p->d), real_of(0.0f));
#endif
    p->alpha = pick(seen, p->throughput.x, p->alpha);
#endif
#if HAS_AREA_EMITTERS
    paths_add_emission(scene, p, surface, hit.prim, hit.t, met);
#endif
}

/* In which of the `diffuse` lanes the path ends with its light sample. */
CLR_INLINE mask_l paths_final(const SceneData *scene, const Paths *p, Surface surface,
                              mask_l diffuse) {
#if FINAL_BY_LIGHTS
    /* Close to the light, where it looks large, the ray that could meet it is worth tracing. */
    __global const FrameData *f = scene->frame;
    __global const clr_real *light = scene->lights->position;
    vec3 to_light = v3_sub(v3_of(light[0], light[1], light[2]), surface.p);
    return diffuse & ige(p->depth, int_of(f->max_depth - 2)) &
           gt(v3_dot(to_light, to_light), real_of(f->final_distance2));
#else
    return no_lanes();
#endif
}

/* Samples the lights, and a direction for the lanes in `going`, whose paths meet `material` at an
   angle with this cosine, negative from the back. Those in `through` stay as they are. */
CLR_INLINE void paths_scatter(const SceneData *scene, Paths *p, Surface surface, int_l prim,
                              int_l material, real cosine, mask_l going, mask_l through) {
    PROFILE_ADD(scene->counts, PROFILE_BOUNCES, count_lanes(going));
    Bsdf bsdf = bsdf_fetch(scene, surface, ipick(going, material, int_of(0)), going);
    mask_l back = lt(cosine, real_of(0.0f));
    vec3 n = v3_scale(surface.ns, copysign(real_of(1.0f), cosine));
    mask_l diffuse = going & bsdf_is(bsdf, CLR_BSDF_DIFFUSE);
    BounceLanes lanes;
    lanes.going = going;
    lanes.directions = diffuse;
    lanes.lobes = going & bsdf_is(bsdf, CLR_BSDF_DIELECTRIC);
    lanes.parted = no_lanes();
#if HAS_LIGHTS && HAS_DIFFUSE && STRATEGY != 2
    if (LIGHT_SAMPLES > 1)
        lanes.parted = diffuse & p->first;
#endif
    lanes.ordered = lanes.parted | (going & ilt(p->depth, int_of(ORDERED_BOUNCES)));
    BounceNumbers numbers = sampler_bounce(p->sampler, lanes);
#if HAS_LIGHTS && HAS_DIFFUSE && STRATEGY != 2
    mask_l final = paths_final(scene, p, surface, diffuse);
    vec3 light_o = ray_origin(surface, n);
    LightSample light;
    light.valid = no_lanes();
    if (any_lane(diffuse))
        light = light_sample(scene, light_o, n, numbers, sampler_of_part(p->sampler, 0u), diffuse);
#endif

    /* Between a light's sample and its shadow ray, although paths that end there do not need it:
       the one is waited for, and the next ray then waits for neither. Lanes that have ended may go
       on computing nonsense: nothing of it is looked at. */
    BsdfSample sample = bsdf_sample(bsdf, p->d, n, fabs(cosine), back, numbers.lobe, numbers.bsdf_u,
                                    numbers.bsdf_v);
    mask_l moved = ~through;
    p->throughput = v3_pick(moved, v3_mul(p->throughput, sample.weight), p->throughput);
    p->o = v3_pick(moved, ray_origin(surface, sample.wo), p->o);
    p->d = v3_pick(moved, renormalize(sample.wo), p->d);
    p->self = ipick(moved, prim, p->self);
    real pdf = pick(lanes.parted, sample.pdf * (1.0f / LIGHT_SAMPLES), sample.pdf);
    p->first &= ~lanes.parted;
    p->prev_pdf = pick(moved, pdf, p->prev_pdf);
#if LIGHT_COUNT == -1
    p->prev_n = v3_pick(moved, n, p->prev_n);
#endif
    p->eta2 = pick(moved, p->eta2 * sample.eta * sample.eta, p->eta2);
    p->depth -= moved;

#if HAS_LIGHTS && HAS_DIFFUSE && STRATEGY != 2
    if (any_lane(diffuse))
        paths_add_direct(scene, p, light_o, n, prim, light, final, lanes.parted);
    p->alive &= ~final;
#endif
    vec3 size = v3(fabs(p->throughput.x), fabs(p->throughput.y), fabs(p->throughput.z));
    p->alive &= ~moved | gt(v3_max(size), real_of(0.0f));
#if HAS_ROULETTE
    paths_roulette(scene, p);
#endif
    Sampler next = p->sampler;
    sampler_advance(&next, BOUNCE_DIMENSIONS);
    p->sampler = sampler_pick(moved, next, p->sampler);
}
#endif

/* From one vertex to the next. */
CLR_INLINE void paths_step(const SceneData *scene, Paths *p) {
    p->rays += (uint)count_lanes(p->alive);
    PROFILE_ADD(scene->counts, PROFILE_PATH_RAYS, count_lanes(p->alive));
    PROFILE_ADD(scene->counts, PROFILE_STEPS, 1u);
    Hit hit = scene_closest(scene, p->o, p->d, p->self, CLIP_END(p), p->alive);
    mask_l met = p->alive & ige(hit.prim, int_of(0));
#if HAS_CLIP || FAR_CAMERA || INTEGRATOR == 1
    p->t_max = real_of(INFINITY);
#endif
    mask_l restarted = no_lanes();
#if FAR_CAMERA
    restarted = p->alive & ~met & gt(p->ahead, real_of(0.0f));
    p->ahead = pick(restarted, camera_next_leg(p->ahead), pick(p->alive, real_of(0.0f), p->ahead));
    p->o = v3_pick(restarted, v3_mad(p->d, -p->ahead, p->start), p->o);
    real leg =
        pick(gt(p->ahead, real_of(0.0f)), p->ahead - camera_next_leg(p->ahead), p->start_t_max);
    p->t_max = pick(restarted, leg, p->t_max);
#endif

#if INTEGRATOR == 1
    /* The depth is measured from the near clip plane, as in Mitsuba. */
    real distance = (hit.t + p->skipped) * scene->frame->length_unit;
    p->radiance = v3_pick(met, v3_scale(p->throughput, distance), p->radiance);
    p->alpha = pick(met, p->throughput.x, p->alpha);
    p->alive = no_lanes();
#else

#if ENVIRONMENT
    paths_add_environment(scene, p, p->alive & ~met & ~restarted);
#endif
    p->alive = met | restarted;
    if (!any_lane(met))
        return;
    Surface surface = surface_at(scene, p->o, p->d, hit, met);

    mask_l through = no_lanes();
#if HIDE_EMITTERS && HAS_AREA_EMITTERS
    /* Camera rays go straight through everything that emits. */
    through = met & ieq(p->depth, int_of(0)) & ige(surface.emitter, int_of(0));
    p->o = v3_pick(through, ray_origin(surface, p->d), p->o);
    p->self = ipick(through, hit.prim, p->self);
    met &= ~through;
#endif
    paths_see(scene, p, surface, hit, met);

    /* The material of the side that the path comes from. */
    real cosine = -v3_dot(surface.ns, p->d);
    int_l material = material_of_side(surface.materials, lt(cosine, real_of(0.0f)));
    mask_l going = met & ilt(p->depth, int_of(scene->frame->max_depth - 1)) &
                   ~ieq(material, int_of((int)CLR_NO_MATERIAL)) & gt(fabs(cosine), real_of(0.0f));
    p->alive = going | through | restarted;
    if (any_lane(going))
        paths_scatter(scene, p, surface, hit.prim, material, cosine, going, through | restarted);
#endif
}

/* All samples of one block for the pixels of the tile. */
CLR_INLINE void render_block(const SceneData *scene, Work work, BlockSums *block, uint *rays,
                             ItemCounters *counters) {
    Paths p;
    p.alive = p.first = p.pending = no_lanes();
    p.rays = 0u;
    p.sampler = sampler_init(0u, as_uint_l(p.alive), as_uint_l(p.alive));
    p.pixel = p.depth = int_of(0);
    p.self = int_of(-1);
    p.o = p.d = p.throughput = p.radiance = p.prev_n = v3_of(0.0f, 0.0f, 0.0f);
    p.t_max = p.alpha = p.prev_pdf = p.eta2 = p.dx = p.dy = real_of(0.0f);
    p.weight = real_of(1.0f);
#if FAR_CAMERA
    p.ahead = p.start_t_max = p.t_max;
    p.start = p.o;
#endif
#if INTEGRATOR == 1
    p.skipped = p.t_max;
#endif
    int idle_steps = 0, busy_steps = 0;
    for (;;) {
        const int idle = LANES - count_lanes(p.alive);
        idle_steps += idle;
        busy_steps += LANES - idle;
        if (idle == LANES || (idle >= REFILL_LANES && refill_is_due(idle_steps, busy_steps))) {
            idle_steps = busy_steps = 0;
            paths_finish(scene, &p, &work, block, counters);
            if (work_left(&work))
                paths_refill(scene, &p, &work);
            if (!any_lane(p.alive))
                break;
        }
        paths_step(scene, &p);
    }
    *rays += p.rays;
}

/* Item i of the launch renders tile first_item + i of those of `colour` (CLR_ALL_TILES: of all),
   the sample blocks [first_block, end_block). The film holds the rows [film_row, film_end) of the
   picture, all that the launch reaches, and item_counters those of the tiles from first_tile on;
   `control` has the pixels of all control tiles. */
__kernel void path_trace(__global const FrameData *frame, __global const Sphere *spheres,
                         __global const SphereTest *sphere_tests, __global const Planar *planars,
                         __global const PrimitiveRecord *records, __global const BvhNode *nodes,
                         __global const TriangleBlock *triangle_blocks,
                         __global const SphereBlock *sphere_blocks, __global const uint *triangles,
                         __global const clr_real *normals, __global const clr_real *uvs,
                         __global const uint *shape_of, __global const ShapeInfo *shapes,
                         __global const clr_real *shape_frames, __global const Material *materials,
                         __global const EmitterInfo *emitters, __global const Light *lights,
                         __global const LightTriangle *light_triangles,
                         __global const LightNode *light_nodes,
                         __global const TextureInfo *textures, __global const uint *texels_u8,
                         __global const clr_real *texels_f32, __global const clr_real *decode,
                         __global const clr_real *env_texels, __global const clr_real *env_cdf,
                         __global const uint *env_guide, __global const clr_real *filter,
                         __global FilmPixel *film, __global ItemCounters *item_counters,
                         __global ControlPixel *control PROFILE_BUFFER, uint first_item,
                         uint item_count, uint first_block, uint end_block, uint colour,
                         uint stride, uint film_row, uint film_end, uint first_tile) {
    if (get_global_id(0) >= item_count)
        return;
    PROFILE_BEGIN(counts);
    SceneData scene = {frame,           spheres,       sphere_tests,
                       planars,         records,       nodes,
                       triangle_blocks, sphere_blocks, triangles,
                       normals,         uvs,           shape_of,
                       shapes,          shape_frames,  materials,
                       emitters,        lights,        light_triangles,
                       light_nodes,     textures,      texels_u8,
                       texels_f32,      decode,        env_texels,
                       env_cdf,         env_guide,     filter PROFILE_COUNTS};
    const uint dealt = (uint)((ulong)get_global_id(0) * stride % item_count);
    Work work = tile_of_item(frame, first_item + dealt, colour);
    const uint tiles = (frame->width + TILE - 1u) / TILE;
    const uint tile = (uint)work.y / TILE * tiles + (uint)work.x / TILE;
    ItemCounters counters = item_counters[tile - first_tile];
    uint rays = 0;
    ItemCounters uncounted = {0u, 0u, 0u, 0u};
    BlockSums block;
    uint renderings = 1u;
#if !VARIANCE
    (void)control;
#else
    const uint all_tiles = tiles * ((frame->height + TILE - 1u) / TILE);
    const uint group = frame->control_group > 0u ? tile / frame->control_group : 0u;
    if (frame->control_group > 0u &&
        tile == clr_control_tile(group, frame->control_group, all_tiles))
        renderings = 2u;
#endif
    for (uint b = first_block; b < end_block; ++b) {
        work.first_sample = CLR_BLOCK_START(b);
        work.end_sample = min(CLR_BLOCK_START(b + 1u), frame->total_samples);
        const uint samples = work.end_sample - work.first_sample;
        for (uint rendering = 0; rendering < renderings; ++rendering) {
            work.seed = rendering == 0u ? frame->seed : frame->seed ^ CONTROL_SEED;
            work.next_sample = work.first_sample;
            work.next_x = work.next_y = 0;
            block_clear(&block);
            render_block(&scene, work, &block, &rays, rendering == 0u ? &counters : &uncounted);
            if (rendering == 0u)
                film_add(&scene, film, work.x, work.y - (int)film_row, (int)(film_end - film_row),
                         samples, &block);
#if VARIANCE
            if (renderings > 1u)
                control_add(&scene, control + (size_t)group * TILE_PIXELS, &block, rendering,
                            samples);
#endif
        }
    }
    const uint low = counters.rays_low + rays;
    counters.rays_high += low < rays ? 1u : 0u;
    counters.rays_low = low;
    item_counters[tile - first_tile] = counters;
    PROFILE_END(counts);
}
