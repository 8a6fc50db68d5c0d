#include "probe_device.h"

#include "device/kernel_program.h"
#include "device/upload.h"
#include "render/device_scene.h"

#include <cmath>

namespace clrender::selftest {

namespace {

/// The widest filter that is splatted: four pixels.
constexpr int probe_border = 4;

} // namespace

KernelConfig probe_config(int lanes, int filter) {
    KernelConfig config;
    config.LANES = lanes;
    config.HAS_DISKS = config.HAS_UVS = 1;
    config.HAS_BITMAPS_U8 = config.HAS_BITMAPS_F32 = config.HAS_CHECKERBOARDS = 1;
    config.HAS_AREA_EMITTERS = config.HAS_ORIENTED_LIGHTS = 1;
    config.HAS_POINT_LIGHTS = config.HAS_SPHERE_LIGHTS = 1;
    config.HAS_PLANAR_LIGHTS = config.HAS_TRIANGLE_LIGHTS = 1;
    // A huge sphere's second entry follows the first (probe_sphere_huge).
    config.SPHERE_COUNT = config.HUGE_COUNT = 1;
    config.LIGHT_COUNT = CLR_MANY_LIGHTS;
    config.ENVIRONMENT = CLR_ENVIRONMENT_MAP;
    config.HAS_LENS = config.HAS_CLIP = 1;
    config.FILTER = filter;
    config.BORDER = filter == CLR_FILTER_SPLATTED ? probe_border : 0;
    return config;
}

ProbeDevice::ProbeDevice(const DeviceEntry &entry, int lanes, std::vector<KernelSource> sources,
                         double scale)
    : entry_(entry), lanes_(lanes), sources_(std::move(sources)), scale_(scale) {
    with_device("preparing the device", [&] {
        context_ = cl::Context(entry_.device);
        queue_ = cl::CommandQueue(context_, entry_.device);
    });
}

std::size_t ProbeDevice::count(double full) const {
    const double groups = std::ceil(full * scale_ / static_cast<double>(probe_group));
    return static_cast<std::size_t>(std::max(groups, 1.0)) * probe_group;
}

cl::Buffer ProbeDevice::upload_bytes(const void *data, std::size_t bytes) const {
    return with_device("uploading",
                       [&] { return clrender::upload(context_, queue_, data, bytes); });
}

cl::Program ProbeDevice::compile(int filter) const {
    return compile_program(context_, entry_.device,
                           join_sources(sources_, "probes/selftest_probes.cl"),
                           probe_config(lanes_, filter).build_options());
}

cl::Kernel ProbeDevice::kernel(const std::string &name) {
    const int filter = name == "probe_filter_offset" ? CLR_FILTER_SAMPLED : CLR_FILTER_SPLATTED;
    auto program = programs_.find(filter);
    if (program == programs_.end())
        program = programs_.emplace(filter, compile(filter)).first;
    return with_device("taking a kernel",
                       [&] { return cl::Kernel(program->second, name.c_str()); });
}

std::vector<float> ProbeDevice::launch(cl::Kernel &kernel, cl_uint index, const cl::Buffer &in,
                                       std::size_t count, std::size_t out_size) {
    return with_device("running a probe", [&] {
        std::vector<float> values(count * out_size);
        const cl::Buffer out(context_, CL_MEM_READ_WRITE, values.size() * sizeof(float));
        kernel.setArg(index++, in);
        kernel.setArg(index++, out);
        kernel.setArg(index, static_cast<cl_uint>(count));
        // Work-groups of one size: PoCL compiles a kernel anew for each.
        constexpr std::size_t local = 32;
        const std::size_t records = local * static_cast<std::size_t>(lanes_);
        queue_.enqueueNDRangeKernel(kernel, cl::NullRange,
                                    cl::NDRange((count + records - 1) / records * local),
                                    cl::NDRange(local));
        queue_.enqueueReadBuffer(out, CL_TRUE, 0, values.size() * sizeof(float), values.data());
        return values;
    });
}

std::vector<float> ProbeDevice::run_scene(const std::string &name, const FlatScene &flat,
                                          const std::vector<float> &in, std::size_t in_size,
                                          std::size_t out_size) {
    FlatScene uploaded = flat; // DeviceScene takes the arrays away
    const DeviceScene scene(context_, queue_, uploaded);
    cl::Kernel kernel = this->kernel(name);
    const cl_uint index = scene.bind(kernel);
    return launch(kernel, index, upload(in), in.size() / in_size, out_size);
}

} // namespace clrender::selftest
