#pragma once
/// The flat scene in device memory: the only place that uploads.

#include "device/cl_context.h"
#include "flatten/flat_scene.h"

namespace clrender::inline CLR_PRECISION {

/// Bytes of the largest of the arrays that are uploaded.
std::size_t largest_array_bytes(const FlatScene &flat);

class DeviceScene {
public:
    /// Uploads all arrays and frees each of them then: a processor's device memory is the host's.
    /// Empty ones become a few bytes, since OpenCL knows no empty buffers. Throws DeviceError.
    DeviceScene(const cl::Context &context, const cl::CommandQueue &queue, FlatScene &flat);

    /// Binds the buffers to the kernel's first arguments, in order; returns how many.
    cl_uint bind(cl::Kernel &kernel) const;

    /// Sets FrameData::total_samples for the launches that follow.
    void set_samples(const cl::CommandQueue &queue, int samples) const;

    [[nodiscard]] std::size_t bytes() const { return bytes_; }

private:
    std::vector<cl::Buffer> buffers_;
    std::size_t bytes_ = 0;
};

} // namespace clrender::inline CLR_PRECISION
