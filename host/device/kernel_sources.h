#pragma once
/// The OpenCL C texts that the build embeds into the program.

#include <string>
#include <vector>

namespace clrender {

/// `name` is the path below kernels/, as an #include names it.
struct KernelSource {
    std::string name;
    std::string text;
};

const std::vector<KernelSource> &embedded_kernel_sources();

} // namespace clrender
