/* The loop over the samples of a tile; integrator_path.clh and integrator_depth.clh have what a
   path does at each step.

   A work-item renders a tile of TILE x TILE pixels, block of samples by block of samples, LANES
   paths side by side. A lane whose path has ended takes the next sample of the block, so lanes stay
   full; only the end of a block runs with empty ones.

   Reads the scene, adds to the film and to the item's counters. Width: LANES. */

#include "lanes.clh"

#include "film.clh"
#include "integrator_depth.clh"
#include "integrator_path.clh"
#include "paths.clh"
#include "profile.clh"
#include "sampler.clh"
#include "scene.clh"
#include "shared/launch_data.h"

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

/* All samples of one block for the pixels of the tile. */
CLR_INLINE void render_block(const SceneData *scene, Work work, BlockSums *block, uint *rays,
                             ItemCounters *counters) {
    Paths p;
    p.alive = p.first = p.pending = no_lanes();
    p.rays = 0u;
    p.sampler = sampler_init(0u, as_uint_l(p.alive), as_uint_l(p.alive));
    p.pixel = p.depth = int_of(0);
#if FREE_PASSAGES
    p.passages = p.depth;
#endif
#if HIDES_BEHIND_PASSAGES
    p.straight = p.alive;
#endif
#if SPECULAR_CONNECTORS > 0
    p.scatterings = p.depth;
    p.chain = int_of(-1);
    p.chain_x = v3_of(0.0f, 0.0f, 0.0f);
    p.chain_pdf = p.chain_total = real_of(0.0f);
#endif
    p.self = source_none();
    p.o = p.d = p.throughput = p.radiance = p.prev_n = v3_of(0.0f, 0.0f, 0.0f);
    p.t_max = p.alpha = p.prev_pdf = p.eta2 = p.dx = p.dy = real_of(0.0f);
    p.weight = real_of(1.0f);
#if ROULETTE == CLR_ROULETTE_WINDOW
    p.window = p.weight;
#endif
#if FAR_CAMERA
    p.ahead = p.start_t_max = p.t_max;
    p.start = p.o;
#endif
#if INTEGRATOR == CLR_INTEGRATOR_DEPTH
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
__kernel void path_trace(SCENE_PARAMETERS, __global FilmPixel *film,
                         __global ItemCounters *item_counters,
                         __global ControlPixel *control PROFILE_BUFFER, uint first_item,
                         uint item_count, uint first_block, uint end_block, uint colour,
                         uint stride, uint film_row, uint film_end, uint first_tile) {
    if (get_global_id(0) >= item_count)
        return;
    PROFILE_BEGIN(counts);
    const SceneData scene = SCENE_DATA;
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
