/* What the device can do at most, for --profile to compare with: float operations and reading.
   Width: LANES. */

#include "lanes.clh"
#include "shared/peak.h"

/* Each round is CLR_PEAK_FMAS fma on all lanes. What is written has to be computed. */
__kernel void peak_fma(__global float *sums, uint rounds, float factor, float offset) {
    real chain[CLR_PEAK_CHAINS];
#pragma unroll
    for (int i = 0; i < CLR_PEAK_CHAINS; ++i)
        chain[i] = real_of((float)i + (float)get_global_id(0));
    for (uint round = 0; round < rounds; ++round) {
#pragma unroll
        for (int i = 0; i < CLR_PEAK_FMAS; ++i)
            chain[i % CLR_PEAK_CHAINS] =
                fma(chain[i % CLR_PEAK_CHAINS], real_of(factor), real_of(offset));
    }
    real total = chain[0];
#pragma unroll
    for (int i = 1; i < CLR_PEAK_CHAINS; ++i)
        total += chain[i];
    float lanes[LANES];
    store_real(total, lanes);
    float sum = 0.0f;
    for (int i = 0; i < LANES; ++i)
        sum += lanes[i];
    sums[get_global_id(0)] = sum;
}

/* Item i reads `count` (a multiple of 4) vectors of four floats, from i * first on in steps of
   `step`: a run of memory of its own on a CPU, interleaved with its neighbours on a GPU. */
__kernel void peak_read(__global const float4 *data, __global float *sums, uint count, uint first,
                        uint step) {
    float4 a = (float4)(0.0f), b = a, c = a, d = a;
    size_t at = get_global_id(0) * first;
    for (uint i = 0; i < count; i += 4u) {
        a += data[at];
        b += data[at + step];
        c += data[at + 2 * (size_t)step];
        d += data[at + 3 * (size_t)step];
        at += 4 * (size_t)step;
    }
    const float4 sum = a + b + (c + d);
    sums[get_global_id(0)] = sum.x + sum.y + sum.z + sum.w;
}
