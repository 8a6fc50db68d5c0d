/* What camera rays meet first: records for the layers beside the picture (shared/first_hits.h). The
   samples are those of path_trace.cl, by the same random numbers, so layers and picture agree.

   Reads the scene, writes its own records. Width: LANES. */

#include "lanes.clh"

#include "first_hits.clh"
#include "paths.clh"
#include "scene.clh"
#include "shared/first_hits.h"

/* Item i of the launch records run first_item + i of the picture, row by row, into its own place in
   `hits`: the samples [0, samples) of each pixel. `near_offset` is the depth of the near clip
   plane where frame->near_clip leaves it out, in scene units; `differential` the distance of
   neighbouring rays in pixels. */
__kernel void first_hits(SCENE_PARAMETERS, __global float *hits, uint first_item, uint item_count,
                         uint samples, float near_offset, float differential) {
    if (get_global_id(0) >= item_count)
        return;
    const SceneData scene = SCENE_DATA;
    const uint item = first_item + (uint)get_global_id(0);
    const uint runs = (frame->width + CLR_HITS_RUN - 1u) / CLR_HITS_RUN;
    Work work;
    work.x = (int)(item % runs * CLR_HITS_RUN);
    work.y = (int)(item / runs);
    work.width = min(CLR_HITS_RUN, (int)frame->width - work.x);
    work.height = 1;
    work.next_x = work.next_y = 0;
    work.next_sample = work.first_sample = 0u;
    work.end_sample = samples;
    work.seed = frame->seed;

    HitRecords out;
    out.stride = CLR_HITS_OF_RUN(samples);
    __global float *place = hits + (size_t)get_global_id(0) * CLR_HIT_FIELDS(AOVS) * out.stride;
    while (work_left(&work)) {
        out.at = place;
        record_next(&scene, &work, near_offset, differential, &out);
        place += LANES;
    }
}
