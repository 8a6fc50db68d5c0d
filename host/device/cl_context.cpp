#include "cl_context.h"

#include "cache_folder.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fmt/core.h>
#include <fstream>
#include <sched.h>

namespace clrender {

namespace {

/// Processors this process may use: its affinity mask, cut down to the container's quota.
int usable_processors() {
    cpu_set_t set;
    CPU_ZERO(&set);
    int count = sched_getaffinity(0, sizeof(set), &set) == 0 ? CPU_COUNT(&set) : 1;
    std::ifstream quota_file("/sys/fs/cgroup/cpu.max");
    double quota = 0;
    double period = 0;
    if (quota_file >> quota >> period && period > 0)
        count = std::min(count, std::max(1, static_cast<int>(std::lround(quota / period))));
    return count;
}

/// PoCL counts the machine's processors, not the process's. What the user has set stays.
void limit_pocl_threads() {
    setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(usable_processors()).c_str(), 0);
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

DeviceEntry describe(const cl::Device &device, const cl::Platform &platform, int index) {
    DeviceEntry entry;
    entry.index = index;
    entry.device = device;
    entry.name = device.getInfo<CL_DEVICE_NAME>();
    entry.platform = platform.getInfo<CL_PLATFORM_NAME>();
    entry.version = device.getInfo<CL_DEVICE_VERSION>();
    const cl_device_type type = device.getInfo<CL_DEVICE_TYPE>();
    entry.is_cpu = (type & CL_DEVICE_TYPE_CPU) != 0;
    entry.is_gpu = (type & CL_DEVICE_TYPE_GPU) != 0;
    entry.compute_units = static_cast<int>(device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>());
    entry.native_width = static_cast<int>(device.getInfo<CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT>());
    entry.has_double =
        device.getInfo<CL_DEVICE_EXTENSIONS>().find("cl_khr_fp64") != std::string::npos;
    entry.memory_bytes = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
    entry.max_allocation_bytes = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
    return entry;
}

std::string join_names(const std::vector<DeviceEntry> &devices) {
    std::string names;
    for (const DeviceEntry &entry : devices)
        names += fmt::format("{}{}: {}", names.empty() ? "" : ", ", entry.index, entry.name);
    return names;
}

} // namespace

std::vector<DeviceEntry> list_devices() {
    limit_pocl_threads();
    choose_pocl_cache();
    std::vector<DeviceEntry> entries;
    std::vector<cl::Platform> platforms;
    try {
        cl::Platform::get(&platforms);
    } catch (const cl::Error &) {
        return entries;
    }
    // A platform without devices reports an error; the next one may have some.
    for (const cl::Platform &platform : platforms) {
        try {
            std::vector<cl::Device> devices;
            platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
            for (const cl::Device &device : devices)
                entries.push_back(describe(device, platform, static_cast<int>(entries.size())));
        } catch (const cl::Error &) {
            continue;
        }
    }
    return entries;
}

DeviceEntry choose_device(const std::string &spec) {
    const std::vector<DeviceEntry> devices = list_devices();
    if (devices.empty())
        throw DeviceError("no OpenCL device found; install one of the Debian packages "
                          "pocl-opencl-icd (any CPU), intel-opencl-icd (Intel GPUs), "
                          "mesa-opencl-icd (AMD GPUs) or nvidia-opencl-icd (NVIDIA GPUs)");
    const auto first = [&](auto matches) -> const DeviceEntry * {
        const auto found = std::find_if(devices.begin(), devices.end(), matches);
        return found == devices.end() ? nullptr : &*found;
    };
    const auto is_gpu = [](const DeviceEntry &e) { return e.is_gpu; };
    const auto is_cpu = [](const DeviceEntry &e) { return e.is_cpu; };
    const std::string wanted = lower(spec);
    const DeviceEntry *entry = nullptr;
    if (wanted == "auto" || wanted.empty()) {
        entry = first(is_gpu);
        if (entry == nullptr)
            entry = first(is_cpu);
        if (entry == nullptr)
            entry = devices.data();
    } else if (wanted == "gpu") {
        entry = first(is_gpu);
    } else if (wanted == "cpu") {
        entry = first(is_cpu);
    } else if (std::all_of(wanted.begin(), wanted.end(),
                           [](unsigned char c) { return std::isdigit(c) != 0; })) {
        entry = first([&](const DeviceEntry &e) { return std::to_string(e.index) == wanted; });
    } else {
        entry = first([&](const DeviceEntry &e) {
            return lower(e.name + " " + e.platform).find(wanted) != std::string::npos;
        });
    }
    if (entry == nullptr)
        throw DeviceError(fmt::format("no OpenCL device matches '{}'; the devices are {}", spec,
                                      join_names(devices)));
    return *entry;
}

int natural_lanes(const DeviceEntry &entry) {
    if (!entry.is_cpu)
        return 1;
    for (const int lanes : {16, 8})
        if (entry.native_width >= lanes)
            return lanes;
    return 4;
}

} // namespace clrender
