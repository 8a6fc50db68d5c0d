#include "kernel_config.h"

#include <fmt/core.h>

namespace clrender {

std::string KernelConfig::build_options() const {
    std::string options;
#define CLR_CONFIG(name, value, meaning) options += fmt::format("-D" #name "={} ", name);
#include "shared/kernel_config.def"
#undef CLR_CONFIG
    return options;
}

std::string KernelConfig::describe() const {
    std::string text;
#define CLR_CONFIG(name, value, meaning)                                                           \
    if (name != (value))                                                                           \
        text += fmt::format("{}" #name "={}", text.empty() ? "" : " ", name);
#include "shared/kernel_config.def"
#undef CLR_CONFIG
    return text;
}

} // namespace clrender
