#pragma once
/// Kernels from their sources, specialised and compiled.

#include "cl_context.h"
#include "kernel_config.h"
#include "kernel_sources.h"

#include <string>

namespace clrender {

/// The texts below a folder in place of the embedded ones. Throws InputError.
std::vector<KernelSource> read_kernel_sources(const std::string &folder);

/// Compiles `main` (a name in `sources`, of which all others are its headers) with `options` on top
/// of the standard ones. Throws DeviceError with the compiler's log.
cl::Program compile_program(const cl::Context &context, const cl::Device &device,
                            const std::vector<KernelSource> &sources, const std::string &main,
                            const std::string &options);

/// Whether this combination of sources, options, device and driver has been compiled before on this
/// machine, so that the driver's own cache holds it. Remembers it from now on.
bool was_compiled_before(const DeviceEntry &entry, const std::vector<KernelSource> &sources,
                         const std::string &options);

} // namespace clrender
