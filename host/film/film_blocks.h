#pragma once
/// The blocks that the samples of a pixel are summed in; CLR_BLOCK_START says where they begin.

#include "shared/launch_data.h"

namespace clrender {

/// Blocks that hold the first `samples` samples of a pixel, the last one whole or in part.
constexpr int blocks_of(int samples) {
    if (samples <= CLR_BLOCK_START(2))
        return (samples + CLR_BLOCK_START(1) - 1) / CLR_BLOCK_START(1);
    return (samples - 1) / (CLR_BLOCK_START(4) - CLR_BLOCK_START(3)) + 3;
}

/// The least number of samples, `samples` at least, that whole blocks hold.
constexpr int whole_blocks(int samples) {
    return CLR_BLOCK_START(blocks_of(samples));
}

} // namespace clrender
