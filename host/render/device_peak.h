#pragma once
/// What a device can do at most, measured.

#include "device/cl_context.h"
#include "profile.h"

namespace clrender {

/// Runs the kernels of kernels/peak.cl at the device's natural width for about half a second. The
/// queue has to have been made with CL_QUEUE_PROFILING_ENABLE. Throws DeviceError.
DevicePeak measure_peak(const DeviceEntry &entry, const cl::Context &context,
                        const cl::CommandQueue &queue);

} // namespace clrender
