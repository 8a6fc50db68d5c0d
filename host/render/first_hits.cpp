#include "first_hits.h"

#include "shared/first_hits.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Work-items of a work-group, fixed: PoCL compiles anew for each size.
constexpr std::size_t gpu_group = 64;
/// A launch takes about so long, and has so many bytes of records at most.
constexpr double launch_seconds = 0.05;
constexpr std::size_t launch_bytes = std::size_t{64} << 20;

/// The kernel of first hits: the camera and the surfaces of that of the picture.
KernelConfig config_of_hits(KernelConfig config, int fields) {
    config.AOVS = fields;
    config.INTEGRATOR = CLR_INTEGRATOR_DEPTH;
    // As for splatting, which is done on the host: uniform in the pixel, with their places kept.
    if (config.FILTER != CLR_FILTER_CENTERS)
        config.FILTER = CLR_FILTER_SPLATTED;
    config.TILE = CLR_HITS_RUN;
    config.BORDER = config.VARIANCE = config.PROFILE = config.HAS_ALPHA = 0;
    config.HIDE_EMITTERS = config.HAS_ROULETTE = config.FREE_PASSAGES = config.FINAL_BY_LIGHTS = 0;
    config.ENVIRONMENT = CLR_ENVIRONMENT_NONE;
    config.STRATEGY = CLR_STRATEGY_MIS;
    config.LIGHT_COUNT = config.HAS_AREA_EMITTERS = config.SHADOW_FREE_COUNT = 0;
    config.LIGHT_SAMPLES = 1;
    if ((fields & (CLR_AOV_UV | CLR_AOV_TANGENTS | CLR_AOV_UV_PARTIALS)) != 0)
        config.HAS_UVS = 1;
    if ((fields & (CLR_AOV_TANGENTS | CLR_AOV_UV_PARTIALS)) != 0)
        config.HAS_TANGENTS = 1;
    return config;
}

} // namespace

FirstHits::FirstHits(const cl::Context &context, const cl::CommandQueue &queue,
                     const DeviceEntry &entry, const KernelConfig &config, int fields)
    : context_(context), queue_(queue), entry_(entry), config_(config_of_hits(config, fields)),
      group_(config.LANES == 1 && !entry.is_cpu ? gpu_group : 1) {}

void FirstHits::start_compiling(const std::string &kernel_dir) {
    const std::vector<KernelSource> sources =
        kernel_dir.empty() ? embedded_kernel_sources() : read_kernel_sources(kernel_dir);
    const auto build = [this, text = join_sources(sources, "first_hits.cl"),
                        options = config_.build_options()] {
        const auto launch = [&](cl::Kernel &kernel) {
            const cl::Buffer nothing(context_, CL_MEM_READ_WRITE, sizeof(FrameData));
            const auto arguments = kernel.getInfo<CL_KERNEL_NUM_ARGS>();
            constexpr cl_uint wholes = 3, reals = 2;
            for (cl_uint i = 0; i < arguments; ++i) {
                if (i + reals >= arguments)
                    kernel.setArg(i, cl_float{0});
                else if (i + reals + wholes >= arguments)
                    kernel.setArg(i, cl_uint{0});
                else
                    kernel.setArg(i, nothing);
            }
            cl::Event event;
            queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(group_),
                                        cl::NDRange(group_), nullptr, &event);
            event.wait();
        };
        return build_kernel(context_, entry_, text, "first_hits", options, launch);
    };
    // Oclgrind runs kernels on the thread alone that has opened its context.
    const bool apart = entry_.platform != "Oclgrind";
    compiling_ = std::async(apart ? std::launch::async : std::launch::deferred, build);
}

bool FirstHits::run(const DeviceScene &scene, const FlatScene &flat, int samples, int spp,
                    const std::function<bool()> &should_stop, AovSums &sums) {
    cl::Kernel kernel = compiling_.get().kernel;
    const FrameData &frame = flat.frame;
    HitStrip strip;
    strip.width = frame.width;
    strip.samples = static_cast<std::size_t>(samples);
    strip.aovs = config_.AOVS;
    const std::size_t row_floats = strip.runs() * strip.fields() * strip.stride();
    const std::size_t most_rows =
        std::clamp<std::size_t>(launch_bytes / (row_floats * sizeof(float)), 1, frame.height);
    std::vector<float> records(most_rows * row_floats);
    strip.records = records.data();

    bool stopped = false;
    with_device("looking at first hits", [&] {
        const cl::Buffer buffer(context_, CL_MEM_READ_WRITE, records.size() * sizeof(float));
        const cl_uint first_argument = scene.bind(kernel);
        kernel.setArg(first_argument, buffer);
        kernel.setArg(first_argument + 3, static_cast<cl_uint>(samples));
        kernel.setArg(first_argument + 4, static_cast<cl_float>(flat.facts.unstated_near));
        kernel.setArg(first_argument + 5, static_cast<cl_float>(1 / std::sqrt(double(spp))));
        std::size_t rows = 1;
        while (strip.end_row < frame.height && !stopped) {
            strip.first_row = strip.end_row;
            strip.end_row = std::min<std::size_t>(strip.first_row + rows, frame.height);
            const std::size_t items = (strip.end_row - strip.first_row) * strip.runs();
            kernel.setArg(first_argument + 1, static_cast<cl_uint>(strip.first_row * strip.runs()));
            kernel.setArg(first_argument + 2, static_cast<cl_uint>(items));
            const auto start = std::chrono::steady_clock::now();
            queue_.enqueueNDRangeKernel(kernel, cl::NullRange,
                                        cl::NDRange((items + group_ - 1) / group_ * group_),
                                        cl::NDRange(group_));
            queue_.enqueueReadBuffer(buffer, CL_TRUE, 0,
                                     items * strip.fields() * strip.stride() * sizeof(float),
                                     records.data());
            const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
            sums.take(strip);
            const double wanted = static_cast<double>(rows) * launch_seconds /
                                  std::max(taken.count(), launch_seconds / 64);
            rows = std::clamp<std::size_t>(static_cast<std::size_t>(wanted), 1, most_rows);
            stopped = should_stop && should_stop() && strip.end_row < frame.height;
        }
    });
    return !stopped;
}

} // namespace clrender::inline CLR_PRECISION
