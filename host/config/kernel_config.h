#pragma once
/// The values the kernel is specialised on, one field for each line of kernel_config.def.

#include "shared/config_values.h"

#include <string>

namespace clrender {

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
