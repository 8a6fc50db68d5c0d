#pragma once
/// Kernels from their sources, specialised and compiled.

#include "cl_context.h"
#include "kernel_sources.h"

#include <functional>
#include <string>

namespace clrender {

/// The texts below a folder in place of the embedded ones. Throws InputError.
std::vector<KernelSource> read_kernel_sources(const std::string &folder);

/// One text: `main` with every header in place of its first #include, one that does not begin with
/// an #ifndef as its guard in place of each; lines numbered as before. Headers are named by their
/// path in `sources`; none is included under a condition, or by itself (it would be left out).
/// Runtimes find a text of one piece in their caches without compiling any of it. Throws
/// DeviceError.
std::string join_sources(const std::vector<KernelSource> &sources, const std::string &main);

/// Compiles a text of one piece, with `options` on top of the standard ones. Throws DeviceError
/// with the compiler's log.
cl::Program compile_program(const cl::Context &context, const cl::Device &device,
                            const std::string &text, const std::string &options);

struct BuiltKernel {
    cl::Kernel kernel;
    bool cached = false; ///< it did not have to be compiled
    double seconds = 0;
};

/// The kernel `name` of the program `text`, from the cache or compiled. `launch` has to run it
/// once, with as little work as it likes, since drivers put off the larger part of compiling until
/// then. Throws DeviceError with the compiler's log.
BuiltKernel build_kernel(const cl::Context &context, const DeviceEntry &entry,
                         const std::string &text, const std::string &name,
                         const std::string &options,
                         const std::function<void(cl::Kernel &)> &launch);

} // namespace clrender
