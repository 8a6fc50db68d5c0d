#include "render_at_precision.h"

#include "device/cl_context.h"
#include "device/device_scene.h"
#include "device/kernel_program.h"
#include "device_peak.h"
#include "film/film.h"
#include "flatten/flat_scene.h"
#include "launch_plan.h"
#include "log.h"
#include "profile.h"
#include "profile_recorder.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <fmt/core.h>
#include <future>
#include <memory>
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

class Stopwatch {
public:
    explicit Stopwatch(Profile *profile) : profile_(profile) {}

    /// Seconds since the last call, or since it was made; the profile, if any, notes the phase.
    double lap(const char *phase) {
        const auto now = std::chrono::steady_clock::now();
        const double seconds = std::chrono::duration<double>(now - last_).count();
        if (profile_ != nullptr)
            profile_->add_phase(phase, last_, now);
        last_ = now;
        return seconds;
    }

private:
    Profile *profile_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

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

/// What the device keeps of a picture: its pixels, and a record for each work-item's tile.
struct FilmExtent {
    std::size_t pixels, tiles_x, tiles_y;

    FilmExtent(const FrameData &frame, std::size_t tile)
        : pixels(static_cast<std::size_t>(frame.width) * frame.height),
          tiles_x((frame.width + tile - 1) / tile), tiles_y((frame.height + tile - 1) / tile) {}

    [[nodiscard]] std::size_t tiles() const { return tiles_x * tiles_y; }
    [[nodiscard]] std::size_t film_bytes() const { return pixels * sizeof(FilmPixel); }
    [[nodiscard]] std::size_t counter_bytes() const { return tiles() * sizeof(ItemCounters); }
    [[nodiscard]] std::size_t bytes() const { return film_bytes() + counter_bytes(); }
};

/// One render: the device's side of the film and the launches that fill it.
class PathTracer {
public:
    PathTracer(const DeviceEntry &entry, const FlatScene &flat, const RenderOptions &options)
        : entry_(entry), flat_(flat), options_(options),
          extent_(flat.frame, static_cast<std::size_t>(flat.config.TILE)),
          group_(flat.config.LANES == 1 && !entry.is_cpu ? gpu_group : cpu_group) {
        with_device("opening the device", [&] {
            context_ = cl::Context(entry.device);
            queue_ = cl::CommandQueue(context_, entry.device,
                                      options.profile != nullptr ? CL_QUEUE_PROFILING_ENABLE : 0);
        });
    }

    /// Starts to compile, on a thread of its own.
    void start_compiling();
    /// Waits for the kernel.
    void compile(RenderStats &stats);
    void upload(RenderStats &stats);
    /// True if it was stopped.
    bool render(int spp, Stopwatch &watch, RenderStats &stats);
    void read(RenderResult &result, PixelFormat format);
    /// What is left for the profile, if there is one, after all else.
    void complete_profile(const RenderStats &stats);

private:
    struct Pending {
        LaunchPlan::Launch launch;
        cl::Event event;
        std::chrono::steady_clock::time_point start;
    };

    void enqueue(const LaunchPlan::Launch &launch, cl::Event *event);
    void finish(Pending &pending, LaunchPlan &plan, int spp);

    const DeviceEntry &entry_;
    const FlatScene &flat_;
    const RenderOptions &options_;
    FilmExtent extent_;
    std::size_t group_;
    cl::Context context_;
    cl::CommandQueue queue_;
    std::future<BuiltKernel> compiling_;
    cl::Kernel kernel_;
    cl_uint launch_arguments_ = 0;
    std::unique_ptr<DeviceScene> scene_;
    cl::Buffer film_, counters_;
    std::unique_ptr<ProfileRecorder> recorder_; ///< where a profile is wanted
    double paths_done_ = 0;
    std::chrono::steady_clock::time_point last_finish_{};
};

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
        queue_.enqueueFillBuffer(film_, cl_uint{0}, 0, extent_.film_bytes());
        queue_.enqueueFillBuffer(counters_, cl_uint{0}, 0, extent_.counter_bytes());
        launch_arguments_ = scene_->bind(kernel_);
        kernel_.setArg(launch_arguments_++, film_);
        kernel_.setArg(launch_arguments_++, counters_);
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
    const int first = pending.launch.first_block * CLR_BLOCK_SAMPLES;
    const int end = std::min(pending.launch.end_block * CLR_BLOCK_SAMPLES, spp);
    const double share =
        static_cast<double>(pending.launch.item_count) / static_cast<double>(extent_.tiles());
    paths_done_ += share * static_cast<double>(extent_.pixels) * (end - first);
    if (options_.on_progress)
        options_.on_progress(paths_done_);
}

bool PathTracer::render(int spp, Stopwatch &watch, RenderStats &stats) {
    const int blocks = (spp + CLR_BLOCK_SAMPLES - 1) / CLR_BLOCK_SAMPLES;
    const std::size_t least_items =
        round_up(static_cast<std::size_t>(entry_.compute_units) * 4, group_);
    LaunchPlan plan(extent_.tiles_x, extent_.tiles_y, blocks, flat_.config.FILTER == 3,
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
    stats.seconds_render = watch.lap("render");
    return stopped && !plan.done();
}

void PathTracer::read(RenderResult &result, PixelFormat format) {
    std::vector<FilmPixel> film(extent_.pixels);
    std::vector<ItemCounters> counters(extent_.tiles());
    with_device("reading the film", [&] {
        queue_.enqueueReadBuffer(film_, CL_TRUE, 0, extent_.film_bytes(), film.data());
        queue_.enqueueReadBuffer(counters_, CL_TRUE, 0, extent_.counter_bytes(), counters.data());
    });
    const auto width = static_cast<int>(flat_.frame.width);
    const auto height = static_cast<int>(flat_.frame.height);
    result.image = film_mean(film, width, height, format);
    result.variance = film_variance(film, width, height, format);

    RenderStats &stats = result.stats;
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

FlattenOptions flatten_options(const RenderOptions &options) {
    FlattenOptions flatten_options;
    flatten_options.brute_force = options.brute_force;
    flatten_options.pixel_centers = options.pixel_centers;
    flatten_options.strategy = options.strategy;
    flatten_options.light_samples = options.light_samples;
    flatten_options.generality = options.generality;
    return flatten_options;
}

/// The side of a work-item's square. Splatted filters need one that reaches no further than the
/// next.
int tile_of(const DeviceEntry &entry, const KernelConfig &config) {
    return entry.is_cpu || config.FILTER == 3 ? cpu_tile : gpu_tile;
}

} // namespace

std::size_t device_bytes_at_precision(const Scene &scene, const RenderOptions &options) {
    FlatScene flat = flatten(scene, flatten_options(options));
    build_hierarchy(flat);
    int tile = cpu_tile;
    try {
        tile = tile_of(choose_device(options.device), flat.config);
    } catch (const DeviceError &) {
        // A scene can be checked where there is no device: it will be one like this.
    }
    return flat.bytes() + FilmExtent(flat.frame, static_cast<std::size_t>(tile)).bytes();
}

RenderResult render_at_precision(const Scene &scene, const RenderOptions &options) {
    RenderResult result;
    RenderStats &stats = result.stats;
    Stopwatch watch(options.profile);
    const DeviceEntry entry = choose_device(options.device);
    stats.device = entry.name;
    stats.seconds_device = watch.lap("open the device");
    log::detail(fmt::format("device: {} ({})", entry.name, entry.platform));

    if (CLR_DOUBLE != 0 && !entry.has_double)
        throw DeviceError(fmt::format("{} has no double precision (cl_khr_fp64)", entry.name));

    FlatScene flat = flatten(scene, flatten_options(options));
    const int spp = options.spp > 0 ? options.spp : scene.sample_count;
    flat.config.DOUBLE_PRECISION = CLR_DOUBLE;
    flat.config.LANES = CLR_DOUBLE ? 1 : options.lanes > 0 ? options.lanes : natural_lanes(entry);
    flat.config.TILE = tile_of(entry, flat.config);
    flat.config.SAMPLER = options.independent_sampler ? 1 : 0;
    flat.config.PROFILE = options.profile != nullptr ? 1 : 0;
    flat.frame.seed = options.seed;
    flat.frame.total_samples = static_cast<uint>(spp);
    stats.lanes = flat.config.LANES;
    stats.width = static_cast<int>(flat.frame.width);
    stats.height = static_cast<int>(flat.frame.height);
    stats.spp = spp;
    stats.triangles = flat.triangle_count;

    // The kernel is compiled while the hierarchy is being built.
    PathTracer tracer(entry, flat, options);
    tracer.start_compiling();
    build_hierarchy(flat);
    stats.host_bytes = flat.bytes();
    stats.seconds_build = watch.lap("build");
    tracer.compile(stats);
    stats.seconds_compile = watch.lap("compile");
    tracer.upload(stats);
    stats.seconds_upload = watch.lap("upload");
    result.interrupted = tracer.render(spp, watch, stats);
    tracer.read(result, scene.film.pixel_format);
    watch.lap("read");
    if (options.profile != nullptr) {
        tracer.complete_profile(stats);
        watch.lap("measure peak");
    }
    if (stats.nonfinite_samples > 0)
        log::warn(fmt::format("{} samples were not finite and count as black; the first in pixel "
                              "({}, {})",
                              stats.nonfinite_samples, stats.nonfinite_x, stats.nonfinite_y));
    return result;
}

} // namespace clrender::inline CLR_PRECISION
