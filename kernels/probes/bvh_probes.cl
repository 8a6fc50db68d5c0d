/* Runs the traversal alone, for tests and for the benchmark. Reads the tree and `rays`, writes one
   record a ray. */

#include "bvh_packet.clh"
#include "probes/probe_rays.clh"

PROBE_CLOSEST(probe_bvh_closest, bvh_closest)
PROBE_ANY(probe_bvh_any, bvh_any)

#if HAS_BVH_PACKETS
/* As probe_bvh_closest, by packets: rays that no packet takes get the prim BVH_PROBE_NOT_TRACED. */
__kernel void probe_bvh_packet(PROBE_PARAMETERS) {
    PROBE_BEGIN;
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
        bvh_closest_packet(nodes, triangles, spheres, &prepared, coherent, &hit);
    }
    store_int(coherent, packed);
    store_int(hit.prim, prim);
    store_real(hit.t, t);
    store_real(hit.u, u);
    store_real(hit.v, v);
    for (uint i = 0u; i < LANES && first + i < count; ++i) {
        const uint met = prim[i] == BVH_NO_PRIM_L ? BVH_NO_PRIM : (uint)prim[i];
        const BvhProbeHit written = {t[i], packed[i] ? met : BVH_PROBE_NOT_TRACED, u[i], v[i]};
        hits[first + i] = written;
    }
}
#endif
