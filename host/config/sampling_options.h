#pragma once
/// How paths are sampled and traced, as far as the command line says.

#include "forced_features.h"
#include "shared/config_values.h"

namespace clrender {

/// How light is looked for: KernelConfig::STRATEGY.
enum class Strategy {
    mis = CLR_STRATEGY_MIS,
    light = CLR_STRATEGY_LIGHT,
    bsdf = CLR_STRATEGY_BSDF,
};

struct SamplingOptions {
    bool brute_force = false;         ///< test every triangle: --accel none
    bool pixel_centers = false;       ///< all samples at pixel centres
    bool independent_sampler = false; ///< in place of Sobol' points
    Strategy strategy = Strategy::mis;
    bool specular_connections = true; ///< light sampling over mirrors and through balls of glass
    bool first_hits = false; ///< layers want to know what camera rays meet (FlatScene::hits)
    int light_samples = 0; ///< where a path first meets a diffuse surface: a power of 2; 0: chosen
    ForcedFeatures forced_features; ///< what the kernel is to be able to do beyond the scene
};

} // namespace clrender
