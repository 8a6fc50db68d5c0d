#pragma once
/// A kernel that can do more than its scene needs: for measuring what specialising it brings.

#include <set>
#include <string>

namespace clrender {

struct KernelConfig;

/// Names of kernel_config.def that the kernel is to be able to do, needed or not.
using ForcedFeatures = std::set<std::string>;

/// All that a kernel can be compiled with for any scene. What decides how the picture is defined
/// (filter, sampler, integrator, hidden emitters) is not among it, nor is the width.
const ForcedFeatures &all_features();

/// Whether a field is among them, or one of them does not compile without it.
bool is_forced(const ForcedFeatures &features, const std::string &name);

/// Sets the fields of these names, and what they need, to what serves every scene. flatten() puts
/// in what shifts indices (a sphere and a rectangle that no ray meets, lights without light) and
/// the map of an environment that is none, which is why ENVIRONMENT is left to config_of(), as is
/// ROULETTE, which is added only where the scene has none.
void force_features(const ForcedFeatures &features, KernelConfig &config);

} // namespace clrender
