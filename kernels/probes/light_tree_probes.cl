/* Walks the light tree for tests, LANES points a work-item. Built with LIGHT_COUNT=-1. */

#include "light_tree.clh"

CLR_INLINE vec3 probe_load(__global const float *in, uint first, uint count) {
    float x[LANES], y[LANES], z[LANES];
    for (uint i = 0; i < LANES; ++i) {
        const uint at = 3u * min(first + i, count - 1u);
        x[i] = in[at];
        y[i] = in[at + 1u];
        z[i] = in[at + 2u];
    }
    return v3(load_real(x), load_real(y), load_real(z));
}

/* For point i with normal i and number u[i]: the light that is chosen (CLR_NONE for none), the
   probability that the choice states, and the one that the trail of that light gives. */
__kernel void probe_light_tree(__global const LightNode *nodes, __global const uint *trails,
                               __global const float *points, __global const float *normals,
                               __global const float *numbers, __global uint *chosen,
                               __global float *stated, __global float *found, uint count) {
    const uint first = (uint)get_global_id(0) * LANES;
    SceneData scene;
    scene.light_nodes = nodes;
    vec3 p = probe_load(points, first, count), n = probe_load(normals, first, count);
    float u[LANES], probability[LANES], again[LANES];
    int light[LANES], on[LANES];
    uint trail[LANES], item[LANES];
    for (uint i = 0; i < LANES; ++i) {
        item[i] = first + i;
        u[i] = numbers[min(first + i, count - 1u)];
    }
    Sampler sampler = sampler_init(1u, load_uint(item), load_uint(item));
    mask_l active = all_lanes();
    real value;
    store_int(light_tree_choose(&scene, p, n, load_real(u), sampler, 0u, &active, &value), light);
    store_real(value, probability);
    store_int(active, on);
    for (uint i = 0; i < LANES; ++i)
        trail[i] = on[i] ? trails[light[i]] : 0u;
    store_real(light_tree_probability(&scene, p, n, load_uint(trail), active), again);
    for (uint i = 0; i < LANES && first + i < count; ++i) {
        chosen[first + i] = on[i] ? (uint)light[i] : CLR_NONE;
        stated[first + i] = probability[i];
        found[first + i] = again[i];
    }
}

/* For point i with normal i: the probability of the light at the end of trail i. */
__kernel void probe_light_probability(__global const LightNode *nodes, __global const uint *trails,
                                      __global const float *points, __global const float *normals,
                                      __global float *probability, uint count) {
    const uint first = (uint)get_global_id(0) * LANES;
    SceneData scene;
    scene.light_nodes = nodes;
    vec3 p = probe_load(points, first, count), n = probe_load(normals, first, count);
    uint trail[LANES];
    float value[LANES];
    for (uint i = 0; i < LANES; ++i)
        trail[i] = trails[min(first + i, count - 1u)];
    store_real(light_tree_probability(&scene, p, n, load_uint(trail), all_lanes()), value);
    for (uint i = 0; i < LANES && first + i < count; ++i)
        probability[first + i] = value[i];
}
