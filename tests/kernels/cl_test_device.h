#pragma once
/// An OpenCL device for probe kernels: the tests' and benchmarks' own, without the renderer's.

#include "device/kernel_sources.h"
#include "device/upload.h"

#include <CL/opencl.hpp>
#include <span>
#include <string>
#include <vector>

namespace clrender::test {

/// The first device of all platforms, or the one whose number is in CLRENDER_TEST_DEVICE.
/// Throws cl::Error or std::runtime_error with the build log.
class ClTestDevice {
public:
    ClTestDevice();

    /// The program of one of `sources`, the others being the headers it may include.
    [[nodiscard]] cl::Program
    build(const std::string &name, const std::string &options,
          const std::vector<KernelSource> &sources = embedded_kernel_sources()) const;

    /// A buffer with a copy of `values`.
    template <class T> [[nodiscard]] cl::Buffer upload(std::span<const T> values) const {
        return clrender::upload(context_, queue_, values.data(), values.size_bytes());
    }

    [[nodiscard]] cl::Buffer allocate(std::size_t bytes) const {
        return cl::Buffer(context_, CL_MEM_READ_WRITE, bytes);
    }

    template <class T>
    [[nodiscard]] std::vector<T> download(const cl::Buffer &buffer, std::size_t count) const {
        std::vector<T> values(count);
        queue_.enqueueReadBuffer(buffer, CL_TRUE, 0, count * sizeof(T), values.data());
        return values;
    }

    /// Runs `kernel` over at least `items` work-items, in groups of `local`, and waits.
    void run(const cl::Kernel &kernel, std::size_t items, std::size_t local = 64) const;

    /// What a kernel (records, results, number of records), `lanes` of them an item, makes of `in`:
    /// `out_size` numbers for each `in_size`.
    template <class Real>
    std::vector<Real> run_records(cl::Kernel &kernel, int lanes, const std::vector<Real> &in,
                                  std::size_t in_size, std::size_t out_size) const {
        const std::size_t count = in.size() / in_size;
        const cl::Buffer records = upload<Real>(in);
        const cl::Buffer results = allocate(count * out_size * sizeof(Real));
        kernel.setArg(0, records);
        kernel.setArg(1, results);
        kernel.setArg(2, static_cast<cl_uint>(count));
        const auto width = static_cast<std::size_t>(lanes);
        run(kernel, (count + width - 1) / width);
        return download<Real>(results, count * out_size);
    }

    [[nodiscard]] std::string name() const;

    /// Floats of a vector register.
    [[nodiscard]] int native_width() const;

private:
    cl::Device device_;
    cl::Context context_;
    cl::CommandQueue queue_;
};

/// True under CLRENDER_TEST_SMALL=1: fewer rays, for Oclgrind and other slow devices.
[[nodiscard]] bool small_tests();

/// True under CLRENDER_STRESS=full (scripts/stress): the sizes that robustness asks for, where the
/// ordinary tests have a part of them.
[[nodiscard]] bool full_stress();

} // namespace clrender::test
