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

/* The state of the paths. `o` lies on primitive `self` (-1: the camera); `prev_pdf` is the density
   of the last direction, infinite where the last vertex was specular or the camera, divided by the
   number of lights that were sampled there, and `prev_n` the normal there; `first` marks paths that
   have met nothing diffuse yet; `eta2` undoes the compression of radiance in roulette; `radiance`
   is what the sample has gathered. */
typedef struct {
    mask_l alive, first;
    vec3 o, d;
    int_l self;
    real t_max;
    vec3 throughput, radiance;
    real alpha;
    real prev_pdf;
    vec3 prev_n;
    real eta2;
    int_l depth;
    Sampler sampler;
    int_l pixel; /* of the tile, row by row; valid while pending: alive, or not yet added up */
    mask_l pending;
    real weight; /* the camera ray's */
    real dx, dy;
#if HAS_FAR_CAMERA
    real ahead; /* CameraRay::ahead of a camera ray that is under way to `start`, else 0 */
    vec3 start;
    real start_t_max;
#endif
#if INTEGRATOR == 1
    real skipped; /* CameraRay::skipped */
#endif
    uint rays; /* of all lanes together */
} Paths;

/* A tile, cut off where the picture ends, and what is left to do of its current block. */
typedef struct {
    int x, y, width, height;
    int next_x, next_y;
    uint next_sample;
    uint first_sample, end_sample;
    uint seed;
} Work;

CLR_INLINE int work_left(const Work *work) {
    return work->next_y < work->height;
}

/* `count` samples of the current pixel are taken; there are as many. */
CLR_INLINE void work_advance(Work *work, uint count) {
    work->next_sample += count;
    if (work->next_sample < work->end_sample)
        return;
    work->next_sample = work->first_sample;
    if (++work->next_x == work->width) {
        work->next_x = 0;
        ++work->next_y;
    }
}

/* Idle lanes take the next samples in turn; lanes that find none stay idle. */
CLR_INLINE void paths_refill(const SceneData *scene, Paths *p, Work *work) {
    __global const FrameData *f = scene->frame;
    mask_l idle = ~p->alive;
    mask_l fresh = idle;
    int_l sample, px, py;
    const int wanted = count_lanes(idle);
    if (work->next_sample + (uint)wanted <= work->end_sample) {
        /* All from one pixel. */
        sample = rank_of_lanes(idle) + (int)work->next_sample;
        px = int_of(work->next_x);
        py = int_of(work->next_y);
        work_advance(work, (uint)wanted);
    } else {
        int lanes[LANES], samples[LANES], columns[LANES], rows[LANES];
        store_int(idle, lanes);
        for (int i = 0; i < LANES; ++i) {
            samples[i] = (int)work->next_sample;
            columns[i] = work->next_x;
            rows[i] = work->next_y;
            lanes[i] = lanes[i] && work_left(work) ? -1 : 0;
            if (lanes[i])
                work_advance(work, 1u);
        }
        fresh = load_int(lanes);
        sample = load_int(samples);
        px = load_int(columns);
        py = load_int(rows);
    }
    PROFILE_ADD(scene->counts, PROFILE_CAMERA_RAYS, count_lanes(fresh));
    p->pixel = ipick(fresh, py * TILE + px, p->pixel);
    px += work->x;
    py += work->y;
    uint_l linear = as_uint_l(py * (int)f->width + px);
    Sampler sampler = sampler_init(work->seed, linear, as_uint_l(sample));
    CameraRay ray = camera_ray(scene, px, py, sampler);
    sampler_advance(&sampler, CAMERA_DIMENSIONS);
#if HAS_CLIP || INTEGRATOR == 1
    ray.o = v3_mad(ray.d, ray.t_near, ray.o);
    ray.t_far -= ray.t_near;
#endif
#if HAS_FAR_CAMERA
    p->ahead = pick(fresh, ray.ahead, p->ahead);
    p->start = v3_pick(fresh, ray.o, p->start);
    p->start_t_max = pick(fresh, ray.t_far, p->start_t_max);
    ray.o = v3_mad(ray.d, -ray.ahead, ray.o);
    ray.t_far = ray.ahead - camera_next_leg(ray.ahead);
#endif
    p->alive |= fresh;
    p->first |= fresh;
    p->pending |= fresh;
    p->o = v3_pick(fresh, ray.o, p->o);
    p->d = v3_pick(fresh, ray.d, p->d);
    p->self = ipick(fresh, int_of(-1), p->self);
    p->t_max = pick(fresh, ray.t_far, p->t_max);
    p->throughput = v3_pick(fresh, v3(ray.weight, ray.weight, ray.weight), p->throughput);
#if FILTER == 1
    p->weight = pick(fresh, ray.weight, p->weight);
#elif FILTER == 3
    p->dx = pick(fresh, ray.dx, p->dx);
    p->dy = pick(fresh, ray.dy, p->dy);
#endif
    p->radiance = v3_pick(fresh, v3_of(0.0f, 0.0f, 0.0f), p->radiance);
#if INTEGRATOR == 1
    p->skipped = pick(fresh, ray.skipped, p->skipped);
#endif
#if HAS_ALPHA
    p->alpha = pick(fresh, ray.weight * f->env_alpha, p->alpha);
#endif
    p->prev_pdf = pick(fresh, real_of(INFINITY), p->prev_pdf);
    p->eta2 = pick(fresh, real_of(1.0f), p->eta2);
    p->depth = ipick(fresh, int_of(0), p->depth);
    p->sampler = sampler_pick(fresh, sampler, p->sampler);
}

CLR_INLINE void paths_count_nonfinite(const SceneData *scene, const Work *work, mask_l bad,
                                      const int *pixel, ItemCounters *counters) {
    int lanes[LANES];
    store_int(bad, lanes);
    for_each_lane(i, lanes) {
        if (counters->nonfinite == 0)
            counters->first_nonfinite = (uint)(work->y + pixel[i] / TILE) * scene->frame->width +
                                        (uint)(work->x + pixel[i] % TILE);
        counters->nonfinite = add_sat(counters->nonfinite, 1u);
    }
}

/* Adds what the finished paths have gathered to the block; a path that is not finite is counted,
   and counts as black. */
CLR_INLINE void paths_finish(const SceneData *scene, Paths *p, const Work *work, BlockSums *block,
                             ItemCounters *counters) {
    mask_l finished = p->pending & ~p->alive;
    mask_l finite = is_finite(p->radiance.x) & is_finite(p->radiance.y) & is_finite(p->radiance.z);
    vec3 black = v3_of(0.0f, 0.0f, 0.0f);
    vec3 radiance = v3_pick(finite, p->radiance, black);
    int lanes[LANES], pixel[LANES];
    store_int(finished, lanes);
    store_int(p->pixel, pixel);
    if (any_lane(finished & ~finite))
        paths_count_nonfinite(scene, work, finished & ~finite, pixel, counters);
    if (!any_lane(finished))
        return;
#if FILTER != 3
    /* Mostly all lanes have been at one pixel. */
    int first = 0;
    while (!lanes[first])
        ++first;
    if (!any_lane(finished & ~ieq(p->pixel, int_of(pixel[first])))) {
        block_add_lanes(scene, block, pixel[first] % TILE, pixel[first] / TILE, finished, first,
                        v3_pick(finished, radiance, black), pick(finished, p->alpha, real_of(0.0f)),
                        pick(finished, p->weight, real_of(0.0f)));
        p->pending &= p->alive;
        return;
    }
#endif
    float r[LANES], g[LANES], b[LANES], alpha[LANES], weight[LANES], dx[LANES], dy[LANES];
    store_float(radiance.x, r);
    store_float(radiance.y, g);
    store_float(radiance.z, b);
    store_float(p->alpha, alpha);
    store_float(p->weight, weight);
    store_float(p->dx, dx);
    store_float(p->dy, dy);
    for_each_lane(i, lanes) {
        FilmSample s = {r[i], g[i], b[i], alpha[i], weight[i], dx[i], dy[i]};
        block_add_sample(scene, block, pixel[i] % TILE, pixel[i] / TILE, s);
    }
    p->pending &= p->alive;
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
#if HAS_CLIP || HAS_FAR_CAMERA || INTEGRATOR == 1
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
#if HAS_CLIP || HAS_FAR_CAMERA || INTEGRATOR == 1
    p->t_max = real_of(INFINITY);
#endif
    mask_l restarted = no_lanes();
#if HAS_FAR_CAMERA
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
#if HAS_FAR_CAMERA
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

/* The tile that item `index` of a colour renders. */
CLR_INLINE Work tile_of_item(__global const FrameData *frame, uint index, uint colour) {
    const uint odd_x = colour == CLR_ALL_TILES ? 0u : colour & 1u;
    const uint odd_y = colour == CLR_ALL_TILES ? 0u : colour >> 1u;
    const uint step = colour == CLR_ALL_TILES ? 1u : 2u;
    const uint tiles = (frame->width + TILE - 1u) / TILE;
    const uint columns = (tiles - odd_x + step - 1u) / step;
    Work work;
    work.x = (int)((index % columns * step + odd_x) * TILE);
    work.y = (int)((index / columns * step + odd_y) * TILE);
    work.width = min(TILE, (int)frame->width - work.x);
    work.height = min(TILE, (int)frame->height - work.y);
    return work;
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
    const uint all_tiles = tiles * ((frame->height + TILE - 1u) / TILE);
    const uint group = frame->control_group > 0u ? tile / frame->control_group : 0u;
    const uint renderings = frame->control_group > 0u &&
                                    tile == clr_control_tile(group, frame->control_group, all_tiles)
                                ? 2u
                                : 1u;
    for (uint b = first_block; b < end_block; ++b) {
        work.first_sample = CLR_BLOCK_START(b);
        work.end_sample = min(CLR_BLOCK_START(b + 1u), frame->total_samples);
        const uint samples = work.end_sample - work.first_sample;
        for (uint rendering = 0; rendering < renderings; ++rendering) {
            work.seed = rendering == 0u ? frame->seed : frame->seed ^ CONTROL_SEED;
            work.next_sample = work.first_sample;
            work.next_x = work.next_y = 0;
            block_clear(&block, rendering > 0u);
            render_block(&scene, work, &block, &rays, rendering == 0u ? &counters : &uncounted);
            if (rendering == 0u)
                film_add(&scene, film, work.x, work.y - (int)film_row, (int)(film_end - film_row),
                         samples, &block);
            if (renderings > 1u)
                control_add(&scene, control + (size_t)group * TILE_PIXELS, &block,
                            rendering == 0u ? 1.0f : -1.0f);
        }
    }
    const uint low = counters.rays_low + rays;
    counters.rays_high += low < rays ? 1u : 0u;
    counters.rays_low = low;
    item_counters[tile - first_tile] = counters;
    PROFILE_END(counts);
}
