/* Runs the traversal alone, for tests and for the benchmark. LANES rays a work-item, one after the
   other. Reads the tree and `rays`, writes one record a ray. */

#include "bvh_packet.clh"
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

#if HAS_BVH_PACKETS
/* As probe_bvh_closest, by packets: rays that no packet takes get the prim BVH_PROBE_NOT_TRACED. */
__kernel void probe_bvh_packet(__global const BvhNode *nodes,
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
    float t_max[LANES], t[LANES], u[LANES], v[LANES];
    int prim[LANES], usable[LANES], packed[LANES];
    for (uint i = 0u; i < LANES; ++i) {
        t_max[i] = rays[min(first + i, count - 1u)].t_max;
        usable[i] = -(int)(valid >> i & 1u);
    }
    const mask_l coherent = bvh_coherent_lanes(&prepared, load_int(usable));
    const real zero = real_of(0.0f);
    BvhPacketHit hit = {load_real(t_max), zero, zero, int_of(0), int_of(0)};
    if (any_lane(coherent)) {
        const BvhRay ray = bvh_ray(&prepared, bvh_lowest_bit(lane_bits(coherent)));
        const BvhPacket packet = bvh_packet(&prepared, &ray, coherent);
        bvh_closest_packet(nodes, triangles, spheres, &packet, &ray, &hit);
    }
    store_int(coherent, packed);
    store_int(hit.prim, prim);
    store_real(hit.t, t);
    store_real(hit.u, u);
    store_real(hit.v, v);
    for (uint i = 0u; i < LANES && first + i < count; ++i) {
        const uint met = prim[i] == BVH_NO_PRIM_L ? BVH_NO_PRIM : (uint)prim[i];
        hits[first + i].t = t[i];
        hits[first + i].prim = packed[i] ? met : BVH_PROBE_NOT_TRACED;
        hits[first + i].u = u[i];
        hits[first + i].v = v[i];
    }
}
#endif
