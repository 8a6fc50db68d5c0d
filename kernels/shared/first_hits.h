#ifndef CLR_FIRST_HITS_H
#define CLR_FIRST_HITS_H
/* What first_hits.cl records of each sample, for the layers beside the picture.

   A work-item records the first `samples` samples of a run of CLR_HITS_RUN pixels of a row. Its
   record r = pixel * samples + sample lies at r of each field's row of floats, one row after the
   other in the order below; a row has CLR_HITS_OF_RUN(samples) places, so that lanes without a
   sample have one as well. All is 0 where the ray meets nothing.

   Always: the primitive and the instance, as whole numbers, -1 for none.
   CLR_AOV_DEPTH: scene units from the near clip plane along the ray.
   CLR_AOV_POSITION: three, in the renderer's coordinates.
   CLR_AOV_UV: two. CLR_AOV_GEO_NORMAL, CLR_AOV_SH_NORMAL: three each, unit length.
   CLR_AOV_TANGENTS: dp/du and dp/dv, three each, scene units.
   CLR_AOV_UV_PARTIALS: du/dx, dv/dx, du/dy, dv/dy, by pixels.
   CLR_AOV_ALBEDO: three, the diffuse reflectance as Mitsuba defines it.
   CLR_AOV_REFLECTANCE: three, one sample of what the surface scatters of the light of a uniform
   surrounding, 1 at most.
   CLR_AOV_PLACE: two, the place of the sample within its pixel. */

#define CLR_HITS_RUN 8
/* The widest kernel has 16 lanes. */
#define CLR_HITS_OF_RUN(samples) ((CLR_HITS_RUN * (samples) + 15u) / 16u * 16u)

#define CLR_AOV_HAS(aovs, bit, count) (((aovs) & (bit)) != 0 ? (count) : 0)
#define CLR_HIT_FIELDS(aovs)                                                                       \
    (2 + CLR_AOV_HAS(aovs, CLR_AOV_DEPTH, 1) + CLR_AOV_HAS(aovs, CLR_AOV_POSITION, 3) +            \
     CLR_AOV_HAS(aovs, CLR_AOV_UV, 2) + CLR_AOV_HAS(aovs, CLR_AOV_GEO_NORMAL, 3) +                 \
     CLR_AOV_HAS(aovs, CLR_AOV_SH_NORMAL, 3) + CLR_AOV_HAS(aovs, CLR_AOV_TANGENTS, 6) +            \
     CLR_AOV_HAS(aovs, CLR_AOV_UV_PARTIALS, 4) + CLR_AOV_HAS(aovs, CLR_AOV_ALBEDO, 3) +            \
     CLR_AOV_HAS(aovs, CLR_AOV_REFLECTANCE, 3) + CLR_AOV_HAS(aovs, CLR_AOV_PLACE, 2))

#endif
