#include "cl_test_device.h"

#include <cstdlib>
#include <stdexcept>

namespace clrender::test {

namespace {

cl::Device wanted_device() {
    std::vector<cl::Platform> platforms;
    cl::Platform::get(&platforms);
    std::vector<cl::Device> all;
    for (const cl::Platform &platform : platforms) {
        std::vector<cl::Device> devices;
        platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
        all.insert(all.end(), devices.begin(), devices.end());
    }
    const char *number = std::getenv("CLRENDER_TEST_DEVICE");
    const std::size_t index = number != nullptr ? std::strtoul(number, nullptr, 10) : 0;
    if (index >= all.size()) {
        throw std::runtime_error("no OpenCL device number " + std::to_string(index));
    }
    return all[index];
}

} // namespace

ClTestDevice::ClTestDevice()
    : device_(wanted_device()), context_(device_), queue_(context_, device_) {}

cl::Program ClTestDevice::build(const std::string &name, const std::string &options,
                                const std::vector<KernelSource> &sources) const {
    cl::Program main;
    std::vector<cl::Program> headers;
    std::vector<cl_program> header_handles;
    std::vector<const char *> header_names;
    for (const KernelSource &source : sources) {
        if (source.name == name) {
            main = cl::Program(context_, source.text);
        } else {
            headers.emplace_back(context_, source.text);
            header_handles.push_back(headers.back()());
            header_names.push_back(source.name.c_str());
        }
    }
    if (main() == nullptr) {
        throw std::runtime_error("no kernel source " + name);
    }

    const std::string all_options = "-cl-std=CL1.2 " + options;
    const cl_device_id device = device_();
    const cl_int status =
        clCompileProgram(main(), 1, &device, all_options.c_str(), cl_uint(header_handles.size()),
                         header_handles.data(), header_names.data(), nullptr, nullptr);
    if (status != CL_SUCCESS) {
        throw std::runtime_error(name + " does not compile:\n" +
                                 main.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device_));
    }
    // Tests run side by side on one cache of PoCL's: now and then a program does not link while
    // another process stores the same one. The second time it is there.
    try {
        return cl::linkProgram(std::vector<cl::Program>{main});
    } catch (const cl::Error &) {
        return cl::linkProgram(std::vector<cl::Program>{main});
    }
}

void ClTestDevice::run(const cl::Kernel &kernel, std::size_t items, std::size_t local) const {
    const std::size_t global = (items + local - 1) / local * local;
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(global), cl::NDRange(local));
    queue_.finish();
}

int ClTestDevice::native_width() const {
    return static_cast<int>(device_.getInfo<CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT>());
}

std::string ClTestDevice::name() const {
    return device_.getInfo<CL_DEVICE_NAME>();
}

bool small_tests() {
    const char *value = std::getenv("CLRENDER_TEST_SMALL");
    return value != nullptr && std::string(value) == "1";
}

bool full_stress() {
    const char *value = std::getenv("CLRENDER_STRESS");
    return value != nullptr && std::string(value) == "full";
}

} // namespace clrender::test
