#pragma once
/// The choice of a device, and its OpenCL context.

#include "error.h"

#include <CL/opencl.hpp>
#include <string>
#include <vector>

namespace clrender {

/// One device of one platform, as --list-devices shows it; `index` is its number there.
struct DeviceEntry {
    int index = 0;
    cl::Device device;
    std::string name;
    std::string platform;
    std::string version;
    bool is_cpu = false;
    bool is_gpu = false;
    int compute_units = 0;
    int native_width = 1;    ///< floats in a register
    bool has_double = false; ///< kernels may compute in double precision
    std::size_t memory_bytes = 0;
    std::size_t max_allocation_bytes = 0;
};

/// All devices of all platforms. Empty where there is no OpenCL. Tells PoCL, before it starts, how
/// many threads this process may really use.
std::vector<DeviceEntry> list_devices();

/// The device that `spec` names: auto (a GPU if there is one, else a CPU), cpu, gpu, an index or a
/// part of a name, upper and lower case alike. Throws DeviceError that names the package to install
/// or the devices there are.
DeviceEntry choose_device(const std::string &spec);

/// Lanes that suit the device: 1 on a GPU, the width of its registers (4, 8 or 16) on a CPU.
int natural_lanes(const DeviceEntry &entry);

/// Runs `call` and turns an OpenCL error into a DeviceError that names `what` was being done.
template <typename Call> auto with_device(const char *what, Call &&call) {
    try {
        return call();
    } catch (const cl::Error &e) {
        throw DeviceError(std::string("OpenCL failed while ") + what + ": " + e.what() +
                          " returned " + std::to_string(e.err()));
    }
}

} // namespace clrender
