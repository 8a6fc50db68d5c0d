#pragma once
/// The values the kernel is specialised on, one field for each line of kernel_config.def.

#include <string>

namespace clrender {

/// How light is looked for: KernelConfig::STRATEGY.
enum class Strategy {
    mis = 0,   ///< light and BSDF sampling, by multiple importance sampling
    light = 1, ///< light sampling alone
    bsdf = 2,  ///< BSDF sampling alone
};

struct KernelConfig {
#define CLR_CONFIG(name, value, meaning) int name = value;
#include "shared/kernel_config.def"
#undef CLR_CONFIG

    /// The -D options, in the order of the list.
    [[nodiscard]] std::string build_options() const;
    /// The names of the fields that differ from their defaults, with their values, for people.
    [[nodiscard]] std::string describe() const;
};

} // namespace clrender
