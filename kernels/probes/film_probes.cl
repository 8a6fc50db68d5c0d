/* Runs the film's sums alone, for tests, with pixels of one sample's width: FILTER CLR_FILTER_BOX,
 * TILE 1. */

#include "film.clh"

/* Adds `count` values to the integers `total`, all four sides alike; in[i] is in units of the
   highest word. `clamped` counts those that did not fit. */
__kernel void probe_film_integers(__global const float *in, uint count, __global uint *total,
                                  __global uint *clamped) {
    for (uint i = 0; i < count; ++i) {
        const int4 beyond = film_add_exactly(total, CLR_COLOUR_WORDS, (float4)(in[i]));
        clamped[0] += (uint)(beyond.x & beyond.y & beyond.z & beyond.w & 1);
    }
}

/* R, G and B of a pixel's first `samples` samples, of `base` + `step` and `base` - `step` in turn,
   but for the very first, which is `first`; in every other block `other` stands for `base`. */
__kernel void probe_film_pixel(__global const FrameData *frame, __global MeasuredPixel *film,
                               uint samples, float first, float base, float step, float other) {
    SceneData scene;
    scene.frame = frame;
    BlockSums block;
    for (uint b = 0; CLR_BLOCK_START(b) < samples; ++b) {
        const uint start = CLR_BLOCK_START(b);
        const uint end = min(CLR_BLOCK_START(b + 1u), samples);
        const float middle = b % 2u == 0u ? base : other;
        block_clear(&block);
        for (uint i = start; i < end; i += LANES) {
            int_l sample = as_int_l(lane_index() + i);
            mask_l on = ilt(sample, int_of((int)end));
            real value =
                pick(ieq(sample & 1, int_of(0)), real_of(middle + step), real_of(middle - step));
            value = pick(ieq(sample, int_of(0)), real_of(first), value);
            value = pick(on, value, real_of(0.0f));
            real weight = pick(on, real_of(1.0f), real_of(0.0f));
            block_add_lanes(&scene, &block, 0, 0, v3(value, value, value), weight, weight);
        }
        film_add(&scene, &film->sums, 0, 0, 1, end - start, &block);
    }
}
