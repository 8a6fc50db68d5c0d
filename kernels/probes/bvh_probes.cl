/* Runs the traversal alone, for tests and for the benchmark. LANES rays a work-item, one after the
   other. Reads the tree and `rays`, writes one record a ray. */

#include "probes/probe_rays.clh"

__kernel void probe_bvh_closest(__global const BvhNode *nodes,
                                __global const TriangleBlock *triangles,
                                __global const SphereBlock *spheres,
                                __global const BvhProbeRay *rays, __global BvhProbeHit *hits,
                                uint count) {
    const uint first = (uint)get_global_id(0) * LANES;
    if (first >= count) {
        return;
    }
    BvhRays prepared;
    const uint valid = probe_rays(nodes, rays, first, count, &prepared);
    for (uint i = 0u; i < LANES && first + i < count; ++i) {
        BvhHit hit;
        hit.t = rays[first + i].t_max;
        hit.u = hit.v = 0.0f;
        hit.prim = BVH_NO_PRIM;
        if (valid >> i & 1u) {
            const BvhRay ray = bvh_ray(&prepared, i);
            bvh_closest(nodes, triangles, spheres, &ray, &hit);
        }
        hits[first + i].t = hit.t;
        hits[first + i].prim = hit.prim;
        hits[first + i].u = hit.u;
        hits[first + i].v = hit.v;
    }
}

/* As above; of each record only `prim` is written: 1 if anything is hit, else 0. */
__kernel void probe_bvh_any(__global const BvhNode *nodes, __global const TriangleBlock *triangles,
                            __global const SphereBlock *spheres, __global const BvhProbeRay *rays,
                            __global BvhProbeHit *hits, uint count) {
    const uint first = (uint)get_global_id(0) * LANES;
    if (first >= count) {
        return;
    }
    BvhRays prepared;
    const uint valid = probe_rays(nodes, rays, first, count, &prepared);
    for (uint i = 0u; i < LANES && first + i < count; ++i) {
        const BvhRay ray = bvh_ray(&prepared, i);
        hits[first + i].prim =
            (valid >> i & 1u) && bvh_any(nodes, triangles, spheres, &ray, rays[first + i].t_max)
                ? 1u
                : 0u;
    }
}
