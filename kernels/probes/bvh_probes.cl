/* Runs the traversal alone, for tests and for the benchmark. One ray a work-item, width 1.
   Reads the tree and `rays`, writes one record a ray. */

#include "bvh.clh"
#include "shared/bvh_probe.h"

__kernel void probe_bvh_closest(__global const BvhNode *nodes,
                                __global const TriangleBlock *triangles,
                                __global const SphereBlock *spheres,
                                __global const BvhProbeRay *rays, __global BvhProbeHit *hits,
                                uint count) {
    const uint i = (uint)get_global_id(0);
    if (i >= count) {
        return;
    }
    const BvhProbeRay ray = rays[i];
    const float3 o = (float3)(ray.o[0], ray.o[1], ray.o[2]);
    const float3 d = (float3)(ray.d[0], ray.d[1], ray.d[2]);
    BvhHit hit;
    hit.t = ray.t_max;
    hit.u = hit.v = 0.0f;
    hit.prim = BVH_NO_PRIM;
    bvh_closest(nodes, triangles, spheres, o, d, ray.self, &hit);
    hits[i].t = hit.t;
    hits[i].prim = hit.prim;
    hits[i].u = hit.u;
    hits[i].v = hit.v;
}

/* As above; of each record only `prim` is written: 1 if anything is hit, else 0. */
__kernel void probe_bvh_any(__global const BvhNode *nodes, __global const TriangleBlock *triangles,
                            __global const SphereBlock *spheres, __global const BvhProbeRay *rays,
                            __global BvhProbeHit *hits, uint count) {
    const uint i = (uint)get_global_id(0);
    if (i >= count) {
        return;
    }
    const BvhProbeRay ray = rays[i];
    const float3 o = (float3)(ray.o[0], ray.o[1], ray.o[2]);
    const float3 d = (float3)(ray.d[0], ray.d[1], ray.d[2]);
    hits[i].prim = (uint)bvh_any(nodes, triangles, spheres, o, d, ray.self, ray.t_max);
}
