/* The ways over a unit sphere, LANES records a work-item. Built with CONNECTS_SPHERES=1 and
   CONNECTS_GLASS=1. */

#include "probes/probe_values.clh"

#include "sphere_chain.clh"

/* in: a, b, their rests, k, the cosine and the sine of the target, 1 for ways through glass. out,
   for the falling, the rising and the positive piece: whether it has a root, tan(i / 2) there, and
   the geometry term. */
__kernel void probe_sphere_chain(__global const clr_real *in, __global clr_real *out, uint count) {
    const uint first = (uint)get_global_id(0) * LANES, size = 8u, width = 9u;
    SphereChain chain;
    chain.a = probe_in(in, first, count, size, 0u);
    chain.b = probe_in(in, first, count, size, 1u);
    chain.a_rest = probe_in(in, first, count, size, 2u);
    chain.b_rest = probe_in(in, first, count, size, 3u);
    chain.k = probe_in(in, first, count, size, 4u);
    chain.k_rest = (1.0f - chain.k) * (1.0f + chain.k);
    Angle target;
    target.c = probe_in(in, first, count, size, 5u);
    target.s = probe_in(in, first, count, size, 6u);
    const mask_l through = gt(probe_in(in, first, count, size, 7u), real_of(0.5f));
    const ChainPieces pieces = chain_pieces(chain, target, through);
    for (uint piece = 0u; piece < 3u; ++piece) {
        const mask_l has = piece == 0u   ? pieces.falling
                           : piece == 1u ? pieces.rising
                                         : pieces.positive;
        const mask_l falls = piece == 0u ? all_lanes() : no_lanes();
        Angle sought = target;
        if (piece < 2u)
            sought.s = -sought.s;
        const real low = pick(falls, real_of(0.0f), pieces.lowest);
        const real high = pick(falls, pieces.lowest, real_of(1.0f));
        const real t = chain_solve(chain, sought, low, high, falls, has);
        const real geometry = chain_geometry(chain, chain_turn(chain, t), 1.0f / chain.b, target);
        probe_out(probe_flag(has), out, first, count, width, 3u * piece);
        probe_out(t, out, first, count, width, 3u * piece + 1u);
        probe_out(geometry, out, first, count, width, 3u * piece + 2u);
    }
}
