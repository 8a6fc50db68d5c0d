#pragma once
/// Copies on the device.

#include <CL/opencl.hpp>
#include <cstddef>

namespace clrender {

/// A read-only buffer with a copy of `bytes` bytes, filled up with zeros to the size of any record
/// of the scene. On a processor large ones are laid into large pages: rays read a tree all over,
/// and a million triangles are more than what it keeps the addresses of otherwise. Throws
/// cl::Error.
[[nodiscard]] cl::Buffer upload(const cl::Context &context, const cl::CommandQueue &queue,
                                const void *data, std::size_t bytes);

} // namespace clrender
