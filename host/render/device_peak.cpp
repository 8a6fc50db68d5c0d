#include "device_peak.h"

#include "device/kernel_program.h"
#include "shared/peak.h"

#include <algorithm>
#include <fmt/core.h>

namespace clrender {

namespace {

/// Of each probe the fastest of so many runs counts: what else the machine does only slows it. Slow
/// devices get fewer.
constexpr int most_runs = 5;
constexpr double most_seconds = 1;
/// A run has to take so long for its time to be worth something.
constexpr double least_seconds = 0.01;
/// Far more than caches hold.
constexpr std::size_t stream_bytes = std::size_t{256} << 20;

/// A launch shape that fills the device.
struct Shape {
    std::size_t items, group;
};

Shape full_shape(const DeviceEntry &entry) {
    const auto units = static_cast<std::size_t>(std::max(entry.compute_units, 1));
    return entry.is_cpu ? Shape{units * 4, 1} : Shape{units * 2048, 64};
}

double run(const cl::CommandQueue &queue, const cl::Kernel &kernel, const Shape &shape) {
    cl::Event event;
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(shape.items),
                               cl::NDRange(shape.group), nullptr, &event);
    event.wait();
    const auto start = event.getProfilingInfo<CL_PROFILING_COMMAND_START>();
    const auto end = event.getProfilingInfo<CL_PROFILING_COMMAND_END>();
    return std::max(static_cast<double>(end - start) * 1e-9, 1e-9);
}

double fastest_run(const cl::CommandQueue &queue, const cl::Kernel &kernel, const Shape &shape) {
    double fastest = run(queue, kernel, shape);
    double spent = fastest;
    for (int i = 1; i < most_runs && spent < most_seconds; ++i) {
        const double seconds = run(queue, kernel, shape);
        fastest = std::min(fastest, seconds);
        spent += seconds;
    }
    return fastest;
}

/// Float operations a second.
double peak_flops(const cl::CommandQueue &queue, const cl::Program &program, const Shape &shape,
                  const cl::Buffer &sums, int lanes) {
    cl::Kernel kernel(program, "peak_fma");
    kernel.setArg(0, sums);
    // x = 0.999 x + 0.001 stays an ordinary number for ever.
    kernel.setArg(2, 0.999F);
    kernel.setArg(3, 0.001F);
    cl_uint rounds = 256;
    for (;; rounds *= 2) {
        kernel.setArg(1, rounds);
        if (run(queue, kernel, shape) >= least_seconds || rounds >= (cl_uint{1} << 26))
            break;
    }
    const double fmas =
        static_cast<double>(shape.items) * rounds * CLR_PEAK_FMAS * static_cast<double>(lanes);
    return 2 * fmas / fastest_run(queue, kernel, shape);
}

/// Bytes read a second.
double peak_bandwidth(const DeviceEntry &entry, const cl::Context &context,
                      const cl::CommandQueue &queue, const cl::Program &program, const Shape &shape,
                      const cl::Buffer &sums) {
    constexpr std::size_t vector_bytes = 4 * sizeof(float);
    const std::size_t most =
        std::min({stream_bytes, entry.max_allocation_bytes / 2, entry.memory_bytes / 8});
    const std::size_t count = std::max<std::size_t>(most / vector_bytes / shape.items / 4, 1) * 4;
    const std::size_t bytes = count * shape.items * vector_bytes;
    const cl::Buffer data(context, CL_MEM_READ_ONLY, bytes);
    queue.enqueueFillBuffer(data, cl_float{1}, 0, bytes);
    cl::Kernel kernel(program, "peak_read");
    kernel.setArg(0, data);
    kernel.setArg(1, sums);
    kernel.setArg(2, static_cast<cl_uint>(count));
    kernel.setArg(3, static_cast<cl_uint>(entry.is_cpu ? count : 1));
    kernel.setArg(4, static_cast<cl_uint>(entry.is_cpu ? 1 : shape.items));
    return static_cast<double>(bytes) / fastest_run(queue, kernel, shape);
}

} // namespace

DevicePeak measure_peak(const DeviceEntry &entry, const cl::Context &context,
                        const cl::CommandQueue &queue) {
    return with_device("measuring the device's peak", [&] {
        const int lanes = natural_lanes(entry);
        const cl::Program program = compile_program(
            context, entry.device, join_sources(embedded_kernel_sources(), "peak.cl"),
            fmt::format("-DLANES={}", lanes));
        const Shape shape = full_shape(entry);
        const cl::Buffer sums(context, CL_MEM_READ_WRITE, shape.items * sizeof(float));
        DevicePeak peak;
        peak.flops = peak_flops(queue, program, shape, sums, lanes);
        peak.bandwidth = peak_bandwidth(entry, context, queue, program, shape, sums);
        return peak;
    });
}

} // namespace clrender
