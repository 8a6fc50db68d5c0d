#pragma once
/// The flat scene in device memory: the only place that uploads.

#include "cl_context.h"
#include "flatten/flat_scene.h"

namespace clrender::inline CLR_PRECISION {

class DeviceScene {
public:
    /// Uploads all arrays; empty ones become a few bytes, since OpenCL knows no empty buffers.
    /// Throws DeviceError with the byte counts where the device's memory does not suffice.
    DeviceScene(const cl::Context &context, const cl::CommandQueue &queue, const DeviceEntry &entry,
                const FlatScene &flat, std::size_t film_bytes);

    /// Binds the buffers to the kernel's first arguments, in order; returns how many.
    cl_uint bind(cl::Kernel &kernel) const;

    [[nodiscard]] std::size_t bytes() const { return bytes_; }

private:
    std::vector<cl::Buffer> buffers_;
    std::size_t bytes_ = 0;
};

} // namespace clrender::inline CLR_PRECISION
