#ifndef CLR_CONFIG_VALUES_H
#define CLR_CONFIG_VALUES_H
/* The values of those fields of kernel_config.def that choose one of several. */

/* ENVIRONMENT: what comes from infinitely far away. */
#define CLR_ENVIRONMENT_NONE 0
#define CLR_ENVIRONMENT_CONSTANT 1
#define CLR_ENVIRONMENT_MAP 2

/* FILTER: how samples make pixels. */
#define CLR_FILTER_BOX 0      /* a sample serves the pixel that it lies in */
#define CLR_FILTER_SAMPLED 1  /* likewise; places in proportion to the filter, from its table */
#define CLR_FILTER_CENTERS 2  /* all samples lie at the centres of the pixels */
#define CLR_FILTER_SPLATTED 3 /* a sample serves all pixels that the filter reaches */

/* INTEGRATOR: what a sample is. */
#define CLR_INTEGRATOR_PATH 0
#define CLR_INTEGRATOR_DEPTH 1

/* AOVS: what is recorded of the first hits of camera rays, a bit each; see shared/first_hits.h. */
#define CLR_AOV_DEPTH 1
#define CLR_AOV_POSITION 2
#define CLR_AOV_UV 4
#define CLR_AOV_GEO_NORMAL 8
#define CLR_AOV_SH_NORMAL 16
#define CLR_AOV_TANGENTS 32
#define CLR_AOV_UV_PARTIALS 64
#define CLR_AOV_ALBEDO 128
#define CLR_AOV_REFLECTANCE 256
#define CLR_AOV_PLACE 512
#define CLR_AOV_PASSES 1024 /* nothing more: hits of what lets light pass straight do not count */

/* STRATEGY: how light is looked for. */
#define CLR_STRATEGY_MIS 0   /* light and BSDF sampling, by multiple importance sampling */
#define CLR_STRATEGY_LIGHT 1 /* light sampling alone */
#define CLR_STRATEGY_BSDF 2  /* BSDF sampling alone */

/* SAMPLER: the random numbers. */
#define CLR_SAMPLER_SOBOL 0 /* Owen-scrambled Sobol' points */
#define CLR_SAMPLER_INDEPENDENT 1

/* ROULETTE: how paths may end by chance. */
#define CLR_ROULETTE_NONE 0
#define CLR_ROULETTE_DEPTH 1 /* from the depth on that the scene or the command line states */
#define CLR_ROULETTE_WINDOW                                                                        \
    2 /* where they have become light, from the second diffuse vertex on                           \
       */

/* LIGHT_COUNT: more than one light that is sampled. */
#define CLR_MANY_LIGHTS (-1)

/* MATERIAL_SHADES: what differs between the dielectrics of a scene. */
#define CLR_SHADES_TINTS 1
#define CLR_SHADES_INDICES 2

#endif
