#include "path_tracer.h"

#include "device_peak.h"
#include "film/film.h"
#include "film/film_blocks.h"
#include "flatten/film_filter.h"
#include "log.h"
#include "profile.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <fmt/core.h>
#include <numeric>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Sides of a work-item's tile: enough paths to keep the lanes of a CPU full; on a GPU one pixel,
/// unless samples reach into their neighbours.
constexpr int cpu_tile = CLR_LEAST_TILE;
constexpr int gpu_tile = 1;

/// Work-items of a work-group, fixed: PoCL compiles anew for each size.
constexpr std::size_t cpu_group = 1;
constexpr std::size_t gpu_group = 64;

/// Arguments of the kernel that are numbers, the last ones; the rest are buffers.
constexpr cl_uint launch_numbers = 6;

std::size_t round_up(std::size_t value, std::size_t unit) {
    return (value + unit - 1) / unit * unit;
}

/// A step that visits all of `count` items once, far from one another: near the golden section, and
/// without a divisor in common with the count.
std::size_t dealing_stride(std::size_t count) {
    auto stride = static_cast<std::size_t>(0.618 * static_cast<double>(count)) + 1;
    while (std::gcd(stride, count) > 1)
        ++stride;
    return stride;
}

/// Runs the kernel without any work: no buffer is looked at.
void launch_nothing(const cl::Context &context, const cl::CommandQueue &queue, cl::Kernel &kernel,
                    std::size_t group) {
    const cl::Buffer nothing(context, CL_MEM_READ_WRITE, sizeof(FrameData));
    const auto arguments = kernel.getInfo<CL_KERNEL_NUM_ARGS>();
    for (cl_uint i = 0; i < arguments; ++i) {
        if (i + launch_numbers < arguments)
            kernel.setArg(i, nothing);
        else
            kernel.setArg(i, cl_uint{0});
    }
    cl::Event event;
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(group), cl::NDRange(group),
                               nullptr, &event);
    event.wait();
}

} // namespace

int tile_of(const DeviceEntry &entry, const KernelConfig &config) {
    return entry.is_cpu || config.FILTER == 3 ? cpu_tile : gpu_tile;
}

PathTracer::PathTracer(const DeviceEntry &entry, const FlatScene &flat,
                       const RenderOptions &options)
    : entry_(entry), flat_(flat), options_(options),
      extent_(flat.frame, static_cast<std::size_t>(flat.config.TILE)),
      control_layout_{flat.frame.width, flat.frame.height,
                      static_cast<std::size_t>(flat.config.TILE), flat.frame.control_group},
      group_(flat.config.LANES == 1 && !entry.is_cpu ? gpu_group : cpu_group) {
    with_device("opening the device", [&] {
        context_ = cl::Context(entry.device);
        queue_ = cl::CommandQueue(context_, entry.device,
                                  options.profile != nullptr ? CL_QUEUE_PROFILING_ENABLE : 0);
    });
}

void PathTracer::start_compiling() {
    const std::vector<KernelSource> sources = options_.kernel_dir.empty()
                                                  ? embedded_kernel_sources()
                                                  : read_kernel_sources(options_.kernel_dir);
    const auto build = [this, text = join_sources(sources, "path_trace.cl"),
                        build_options = flat_.config.build_options()] {
        return build_kernel(
            context_, entry_, text, "path_trace", build_options,
            [&](cl::Kernel &kernel) { launch_nothing(context_, queue_, kernel, group_); });
    };
    // Oclgrind runs kernels on the thread alone that has opened its context.
    const bool apart = entry_.platform != "Oclgrind";
    compiling_ = std::async(apart ? std::launch::async : std::launch::deferred, build);
}

void PathTracer::compile(RenderStats &stats) {
    stats.kernel_features = flat_.config.describe();
    log::detail("kernel: " + stats.kernel_features);
    const BuiltKernel built = compiling_.get();
    kernel_ = built.kernel;
    stats.kernel_cached = built.cached;
    stats.seconds_kernel = built.seconds;
}

void PathTracer::upload(RenderStats &stats) {
    scene_ = std::make_unique<DeviceScene>(context_, queue_, entry_, flat_, extent_.bytes());
    with_device("clearing the film", [&] {
        film_ = cl::Buffer(context_, CL_MEM_READ_WRITE, extent_.film_bytes());
        counters_ = cl::Buffer(context_, CL_MEM_READ_WRITE, extent_.counter_bytes());
        const std::size_t control_bytes = std::max(control_layout_.bytes(), sizeof(ControlPixel));
        control_ = cl::Buffer(context_, CL_MEM_READ_WRITE, control_bytes);
        queue_.enqueueFillBuffer(control_, cl_uint{0}, 0, control_bytes);
        queue_.enqueueFillBuffer(film_, cl_uint{0}, 0, extent_.film_bytes());
        queue_.enqueueFillBuffer(counters_, cl_uint{0}, 0, extent_.counter_bytes());
        launch_arguments_ = scene_->bind(kernel_);
        kernel_.setArg(launch_arguments_++, film_);
        kernel_.setArg(launch_arguments_++, counters_);
        kernel_.setArg(launch_arguments_++, control_);
        if (options_.profile != nullptr) {
            recorder_ = std::make_unique<ProfileRecorder>(*options_.profile, context_, queue_);
            kernel_.setArg(launch_arguments_++, recorder_->buffer());
        }
        queue_.finish();
    });
    stats.device_bytes = scene_->bytes() + extent_.bytes();
    if (recorder_)
        stats.device_bytes += recorder_->bytes();
}

void PathTracer::enqueue(const LaunchPlan::Launch &launch, cl::Event *event) {
    with_device("launching the kernel", [&] {
        cl_uint argument = launch_arguments_;
        kernel_.setArg(argument++, static_cast<cl_uint>(launch.first_item));
        kernel_.setArg(argument++, static_cast<cl_uint>(launch.item_count));
        kernel_.setArg(argument++, static_cast<cl_uint>(launch.first_block));
        kernel_.setArg(argument++, static_cast<cl_uint>(launch.end_block));
        kernel_.setArg(argument++, static_cast<cl_uint>(launch.colour));
        kernel_.setArg(argument++, static_cast<cl_uint>(dealing_stride(launch.item_count)));
        queue_.enqueueNDRangeKernel(
            kernel_, cl::NullRange,
            cl::NDRange(round_up(std::max<std::size_t>(launch.item_count, 1), group_)),
            cl::NDRange(group_), nullptr, event);
        queue_.flush();
    });
}

void PathTracer::finish(Pending &pending, LaunchPlan &plan, int spp) {
    with_device("running the kernel", [&] { pending.event.wait(); });
    const auto now = std::chrono::steady_clock::now();
    // Two launches are under way at a time: this one began when the one before it ended.
    const auto start = std::max(pending.start, last_finish_);
    plan.learn(pending.launch, std::chrono::duration<double>(now - start).count());
    last_finish_ = now;
    if (recorder_)
        recorder_->finished(pending.launch, pending.event, pending.start);

    // An estimate for the progress bar: tiles at the border are smaller.
    const int first = CLR_BLOCK_START(pending.launch.first_block);
    const int end = std::min(CLR_BLOCK_START(pending.launch.end_block), spp);
    const double share =
        static_cast<double>(pending.launch.item_count) / static_cast<double>(extent_.tiles());
    paths_done_ += share * static_cast<double>(extent_.pixels) * (end - first);
    if (options_.on_progress)
        options_.on_progress(paths_done_);
}

bool PathTracer::render(int spp) {
    const std::size_t least_items =
        round_up(static_cast<std::size_t>(entry_.compute_units) * 4, group_);
    LaunchPlan plan(extent_.tiles_x, extent_.tiles_y, blocks_of(spp), flat_.config.FILTER == 3,
                    static_cast<std::size_t>(options_.tile), options_.batch, least_items);
    std::deque<Pending> pending;
    bool stopped = false;
    while (!pending.empty() || (!plan.done() && !stopped)) {
        // The next launch waits in the queue while the one before it runs.
        while (pending.size() < 2 && !plan.done() && !stopped) {
            Pending next{plan.next(), {}, std::chrono::steady_clock::now()};
            enqueue(next.launch, &next.event);
            if (recorder_)
                recorder_->enqueued(next.launch);
            pending.push_back(next);
        }
        finish(pending.front(), plan, spp);
        pending.pop_front();
        stopped = stopped || (options_.should_stop && options_.should_stop());
    }
    if (recorder_)
        recorder_->complete(spp);
    return stopped && !plan.done();
}

void PathTracer::read(RenderResult &result, PixelFormat format) {
    Film film;
    film.width = static_cast<int>(flat_.frame.width);
    film.height = static_cast<int>(flat_.frame.height);
    film.exponent = flat_.frame.film_exponent;
    if (flat_.config.BORDER > 0)
        film.spread =
            filter_spread(flat_.filter, double{flat_.frame.filter_radius}, flat_.config.BORDER);
    film.pixels.resize(extent_.pixels);
    std::vector<ItemCounters> counters(extent_.tiles());
    with_device("reading the film", [&] {
        queue_.enqueueReadBuffer(film_, CL_TRUE, 0, extent_.film_bytes(), film.pixels.data());
        queue_.enqueueReadBuffer(counters_, CL_TRUE, 0, extent_.counter_bytes(), counters.data());
    });
    result.image = film_mean(film, format);
    if (options_.with_variance) {
        result.variance = film_variance(film, format);
        std::vector<ControlPixel> control(control_layout_.bytes() / sizeof(ControlPixel));
        if (!control.empty())
            with_device("reading the control tiles", [&] {
                queue_.enqueueReadBuffer(control_, CL_TRUE, 0, control_layout_.bytes(),
                                         control.data());
            });
        result.error.factor =
            variance_factor(control_layout_, control, result.image, film.exponent);
        for (float &value : result.variance.f32)
            value *= static_cast<float>(result.error.factor.value);
        result.error.relative_variance = mean_relative_variance(result.image, result.variance);
    }

    RenderStats &stats = result.stats;
    for (std::size_t i = 0; i < film.pixels.size(); ++i) {
        if (film.pixels[i].clamped == 0)
            continue;
        if (stats.clamped_pixels++ == 0) {
            stats.clamped_x = static_cast<int>(i % flat_.frame.width);
            stats.clamped_y = static_cast<int>(i / flat_.frame.width);
        }
    }
    stats.paths = std::round(paths_done_);
    for (const ItemCounters &c : counters) {
        stats.rays += c.rays_low + 4294967296.0 * c.rays_high;
        if (c.nonfinite > 0 && stats.nonfinite_samples == 0) {
            stats.nonfinite_x = static_cast<int>(c.first_nonfinite % flat_.frame.width);
            stats.nonfinite_y = static_cast<int>(c.first_nonfinite / flat_.frame.width);
        }
        stats.nonfinite_samples += c.nonfinite;
    }
}

void PathTracer::complete_profile(const RenderStats &stats) {
    Profile &profile = *options_.profile;
    profile.device = stats.device;
    profile.config = flat_.config;
    profile.uploaded_bytes = static_cast<double>(scene_->bytes());
    profile.device_bytes = static_cast<double>(stats.device_bytes);
    profile.downloaded_bytes += static_cast<double>(extent_.bytes());
    profile.peak = measure_peak(entry_, context_, queue_);
}

} // namespace clrender::inline CLR_PRECISION
