#pragma once
/// A device with the probe kernels (kernels/probes/selftest_probes.cl) compiled for it.

#include "check.h"
#include "config/kernel_config.h"
#include "device/cl_context.h"
#include "device/kernel_sources.h"
#include "flatten/flat_scene.h"

#include <map>
#include <optional>

namespace clrender::selftest {

/// Records that share a shape, or a sampler's seed and dimension: a multiple of every width.
inline constexpr std::size_t probe_group = 16;

/// What the probes are compiled for: everything that the probed functions can do. `filter` is one
/// of KernelConfig::FILTER.
KernelConfig probe_config(int lanes, int filter);

class ProbeDevice {
public:
    /// `scale` multiplies the number of rays and samples of every check. Throws DeviceError.
    ProbeDevice(const DeviceEntry &entry, int lanes, std::vector<KernelSource> sources,
                double scale = 1);

    [[nodiscard]] int lanes() const { return lanes_; }

    /// So many rays or samples, scaled: whole groups, at least one.
    [[nodiscard]] std::size_t count(double full) const;

    /// A buffer with a copy of `values`; of one byte where there are none.
    template <class T> [[nodiscard]] cl::Buffer upload(const std::vector<T> &values) const {
        return upload_bytes(values.data(), values.size() * sizeof(T));
    }

    /// What kernel `name` makes of the records in `in`: `out_size` floats for each of `in_size`.
    /// `front` are the kernel's arguments before them.
    template <class... Front>
    std::vector<float> run(const std::string &name, const std::vector<float> &in,
                           std::size_t in_size, std::size_t out_size, const Front &...front) {
        cl::Kernel kernel = this->kernel(name);
        cl_uint index = 0;
        (kernel.setArg(index++, front), ...);
        return launch(kernel, index, upload(in), in.size() / in_size, out_size);
    }

    /// The same with the arrays of a scene as the kernel's first arguments.
    std::vector<float> run_scene(const std::string &name, const FlatScene &flat,
                                 const std::vector<float> &in, std::size_t in_size,
                                 std::size_t out_size);

    /// The last arguments of any kernel: what goes in, what comes out, the number of records.
    std::vector<float> launch(cl::Kernel &kernel, cl_uint index, const cl::Buffer &in,
                              std::size_t count, std::size_t out_size);

    /// A kernel of the program that is compiled for this FILTER (0 for any).
    cl::Kernel kernel(const std::string &name);

private:
    [[nodiscard]] cl::Buffer upload_bytes(const void *data, std::size_t bytes) const;
    [[nodiscard]] cl::Program compile(int filter) const;

    DeviceEntry entry_;
    int lanes_;
    std::vector<KernelSource> sources_;
    double scale_;
    cl::Context context_;
    cl::CommandQueue queue_;
    std::map<int, cl::Program> programs_; ///< by FILTER
};

} // namespace clrender::selftest
