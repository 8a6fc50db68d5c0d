#pragma once
/// What the kernel is compiled for, from a finished scene.

#include "config/kernel_config.h"
#include "flat_scene.h"

namespace clrender::inline CLR_PRECISION {

/// What of the configuration the device and the render decide.
struct ConfigOptions {
    int lanes = 1;
    int tile = 1; ///< pixels a side of what a work-item renders; more, where filters are splatted
    bool splat_filters = true; ///< samples serve all pixels that the filter reaches, where it is
                               ///< not too wide; else the filter is sampled
    int bvh_step = 8;          ///< children of a node, and primitives of a block, tested at once
    bool profile = false;
    bool variance = false;
};

/// The least that renders this scene, but for what SamplingOptions::forced_features adds.
/// `sampling` is what the scene was flattened with.
KernelConfig config_of(const FlatScene &flat, const SamplingOptions &sampling,
                       const ConfigOptions &options = {});

} // namespace clrender::inline CLR_PRECISION
