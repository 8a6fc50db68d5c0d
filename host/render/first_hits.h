#pragma once
/// A pass over the picture's first samples that sees what camera rays meet first.

#include "config/kernel_config.h"
#include "device/kernel_program.h"
#include "device_scene.h"
#include "film/aov_sums.h"
#include "flatten/flat_scene.h"
#include "render.h"

#include <future>

namespace clrender::inline CLR_PRECISION {

class FirstHits {
public:
    /// `config`: that of the picture's kernel; `fields`: CLR_AOV_*.
    FirstHits(const cl::Context &context, const cl::CommandQueue &queue, const DeviceEntry &entry,
              const KernelConfig &config, int fields);

    /// Starts to compile, on a thread of its own.
    void start_compiling(const std::string &kernel_dir);
    /// Hands the records of the first `samples` samples of all pixels to `sums`. `spp`: those that
    /// the picture has. False if it was stopped before the end.
    bool run(const DeviceScene &scene, const FlatScene &flat, int samples, int spp,
             const std::function<bool()> &should_stop, AovSums &sums);

private:
    cl::Context context_;
    cl::CommandQueue queue_;
    const DeviceEntry &entry_;
    KernelConfig config_;
    std::size_t group_;
    std::future<BuiltKernel> compiling_;
};

} // namespace clrender::inline CLR_PRECISION
