#include "kernel_config.h"

#include <fmt/core.h>

#include <array>

namespace clrender {

namespace {

struct Field {
    const char *name;
    int KernelConfig::*value;
};

constexpr std::array fields{
#define CLR_CONFIG(name, value, meaning) Field{#name, &KernelConfig::name},
#include "shared/kernel_config.def"
#undef CLR_CONFIG
};

} // namespace

std::string KernelConfig::build_options() const {
    std::string options;
    for (const Field &field : fields)
        options += fmt::format("-D{}={} ", field.name, this->*field.value);
    return options;
}

std::string KernelConfig::describe() const {
    static const KernelConfig defaults;
    std::string text;
    for (const Field &field : fields)
        if (this->*field.value != defaults.*field.value)
            text += fmt::format("{}{}={}", text.empty() ? "" : " ", field.name, this->*field.value);
    return text;
}

} // namespace clrender
