#include "path_tracer.h"

#include "device_peak.h"
#include "film/film_blocks.h"
#include "log.h"
#include "profile.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <fmt/core.h>
#include <numeric>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Sides of a work-item's tile: enough paths to keep the lanes of a CPU full; on a GPU one pixel.
constexpr int cpu_tile = CLR_LEAST_TILE;
constexpr int gpu_tile = 1;

/// Children of a node tested at once: as many as a vector has lanes, or as few as leave registers.
constexpr int cpu_bvh_step = 8;
constexpr int gpu_bvh_step = 4;

/// Work-items of a work-group, fixed: PoCL compiles anew for each size.
constexpr std::size_t cpu_group = 1;
constexpr std::size_t gpu_group = 64;

/// Work-items that hide the latency of a GPU's memory, for each of its compute units.
constexpr std::size_t gpu_items_per_unit = 2048;

/// Arguments of the kernel that are numbers, the last ones; the rest are buffers.
constexpr cl_uint launch_numbers = 9;

/// The sums of a picture stay in one piece up to this share of the device's memory; beyond, bands
/// need not be large to be fast.
constexpr std::size_t film_share = 4;
constexpr std::size_t largest_band = std::size_t{512} << 20;

/// Where the first pass is expected to take longer, all pixels get a sample or a few before it, as
/// long as these are less than a thirtieth of all.
constexpr double long_pass_seconds = 3;
constexpr int least_spp_of_preview = 32;
/// It is found out early: as soon as the speed is known, and in this share of that time.
constexpr double probe_seconds = 0.15;
constexpr double first_probe_share = 0.125, last_probe_share = 0.25;

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

int bvh_step_for(const DeviceEntry &entry) {
    return entry.is_cpu ? cpu_bvh_step : gpu_bvh_step;
}

int tile_for(const DeviceEntry &entry) {
    return entry.is_cpu ? cpu_tile : gpu_tile;
}

PictureTiles tiles_of(const FrameData &frame, const KernelConfig &config) {
    return {frame.width, frame.height, static_cast<std::size_t>(config.TILE),
            static_cast<std::size_t>(config.BORDER), config.VARIANCE != 0};
}

std::vector<Band> bands_of(const DeviceEntry &entry, const PictureTiles &tiles,
                           const RenderOptions &options) {
    const auto rows = static_cast<std::size_t>(options.band_rows);
    const std::size_t limit = std::min(entry.max_allocation_bytes, entry.memory_bytes / film_share);
    std::vector<Band> bands = cut_into_bands(tiles, limit, rows);
    if (bands.size() > 1 && rows == 0)
        bands = cut_into_bands(tiles, std::min(limit, largest_band));
    return bands;
}

PathTracer::PathTracer(const DeviceEntry &entry, FlatScene &flat, const KernelConfig &config,
                       const RenderOptions &options)
    : entry_(entry), flat_(flat), config_(config), options_(options),
      tiles_(tiles_of(flat.frame, config)),
      bands_(bands_of(entry, tiles_, options)), control_{tiles_.width, tiles_.height, tiles_.side,
                                                         flat.frame.control_group},
      group_(config.LANES == 1 && !entry.is_cpu ? gpu_group : cpu_group),
      pace_(tiles_.columns(), tiles_.rows(),
            round_up(static_cast<std::size_t>(entry.compute_units) *
                         (entry.is_cpu ? 1 : gpu_items_per_unit),
                     group_)) {
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
                        build_options = config_.build_options()] {
        return build_kernel(
            context_, entry_, text, "path_trace", build_options,
            [&](cl::Kernel &kernel) { launch_nothing(context_, queue_, kernel, group_); });
    };
    // Oclgrind runs kernels on the thread alone that has opened its context.
    const bool apart = entry_.platform != "Oclgrind";
    compiling_ = std::async(apart ? std::launch::async : std::launch::deferred, build);
}

void PathTracer::compile(RenderStats &stats) {
    stats.kernel_features = config_.describe();
    log::detail("kernel: " + stats.kernel_features);
    const BuiltKernel built = compiling_.get();
    kernel_ = built.kernel;
    stats.kernel_cached = built.cached;
    stats.seconds_kernel = built.seconds;
}

void PathTracer::upload(RenderStats &stats) {
    scene_ = std::make_unique<DeviceScene>(context_, queue_, flat_);
    film_ = std::make_unique<DeviceFilm>(context_, queue_, tiles_, bands_, control_);
    with_device("binding the buffers", [&] {
        launch_arguments_ = film_->bind(kernel_, scene_->bind(kernel_));
        if (options_.profile != nullptr) {
            recorder_ = std::make_unique<ProfileRecorder>(*options_.profile, context_, queue_);
            kernel_.setArg(launch_arguments_++, recorder_->buffer());
        }
    });
    stats.device_bytes = scene_->bytes() + film_->bytes();
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
        const FilmWindow window = film_->window();
        kernel_.setArg(argument++, window.first_row);
        kernel_.setArg(argument++, window.end_row);
        kernel_.setArg(argument++, window.first_tile);
        queue_.enqueueNDRangeKernel(
            kernel_, cl::NullRange,
            cl::NDRange(round_up(std::max<std::size_t>(launch.item_count, 1), group_)),
            cl::NDRange(group_), nullptr, event);
        queue_.flush();
    });
}

void PathTracer::finish(Pending &pending, LaunchPlan &plan) {
    with_device("running the kernel", [&] { pending.event.wait(); });
    const auto now = std::chrono::steady_clock::now();
    // Two launches are under way at a time: this one began when the one before it ended.
    const auto start = std::max(pending.start, last_finish_);
    plan.finished(pending.launch, std::chrono::duration<double>(now - start).count());
    last_finish_ = now;
    if (recorder_)
        recorder_->finished(pending.launch, pending.event, pending.start);

    // An estimate for the progress bar: tiles at the border are smaller.
    const double paths = static_cast<double>(pending.launch.item_count) /
                         static_cast<double>(tiles_.columns() * tiles_.rows()) *
                         static_cast<double>(tiles_.pixels()) * plan.samples_of(pending.launch);
    paths_done_ += paths;
    progress_ += paths;
    if (options_.on_progress)
        options_.on_progress({.paths = progress_ / progress_total_});
    if (!has_samples_)
        log::detail("rendering: the first launch has ended");
    has_samples_ = true;
}

/// Runs the launches of a plan. Ends as `slow` if the first pass soon turns out to take longer than
/// that.
PathTracer::Ended PathTracer::run(LaunchPlan &plan, double slow_seconds) {
    std::deque<Pending> pending;
    Ended ended = Ended::done;
    const auto start = std::chrono::steady_clock::now();
    bool is_due = false;
    while (!pending.empty() || (!plan.done() && ended == Ended::done)) {
        // The sums of a checkpoint are those of launches that have ended.
        if (pending.empty() && is_due)
            write_checkpoint_();
        is_due = is_checkpoint_due_ && !plan.done() && is_checkpoint_due_();
        // The next launch waits in the queue while the one before it runs.
        while (pending.size() < 2 && !plan.done() && ended == Ended::done &&
               (!is_due || pending.empty())) {
            Pending next{plan.next(), {}, std::chrono::steady_clock::now()};
            enqueue(next.launch, &next.event);
            if (recorder_)
                recorder_->enqueued(next.launch);
            pending.push_back(next);
        }
        finish(pending.front(), plan);
        pending.pop_front();
        if (options_.should_stop && options_.should_stop())
            ended = Ended::stopped;
        const std::chrono::duration<double> taken = last_finish_ - start;
        const bool is_early =
            taken.count() > std::min(probe_seconds, first_probe_share * slow_seconds) &&
            taken.count() < last_probe_share * slow_seconds && plan.is_in_first_pass();
        if (ended == Ended::done && is_early && plan.seconds_of_first_pass() > slow_seconds)
            ended = Ended::slow;
    }
    return ended == Ended::stopped && plan.done() ? Ended::done : ended;
}

LaunchPlan PathTracer::plan_of(const Band &band, int spp, int first_block) {
    return {band.tiles,
            spp,
            config_.FILTER == CLR_FILTER_SPLATTED,
            pace_,
            static_cast<std::size_t>(options_.tile),
            options_.batch,
            first_block};
}

void PathTracer::take(Picture &picture, const Band &band, const LaunchPlan &plan) {
    const auto start = std::chrono::steady_clock::now();
    picture.take(*film_, band, plan);
    const auto end = std::chrono::steady_clock::now();
    seconds_read_ += std::chrono::duration<double>(end - start).count();
    if (options_.profile != nullptr)
        options_.profile->add_phase("read", start, end);
}

/// Gives every pixel a few samples, which are taken again with all others.
PathTracer::Ended PathTracer::preview(int spp, Picture &picture, RenderStats &stats) {
    const int samples = preview_samples(spp, bands_.size() > 1);
    progress_ = 0;
    progress_total_ = 1 + static_cast<double>(samples) / spp;
    scene_->set_samples(queue_, samples);
    film_->forget();
    Ended ended = Ended::done;
    for (std::size_t i = 0; i < bands_.size() && ended == Ended::done; ++i) {
        film_->begin(bands_[i]);
        LaunchPlan plan = plan_of(bands_[i], samples);
        ended = run(plan, no_limit);
        take(picture, bands_[i], plan);
        if (ended == Ended::stopped)
            add_counters(stats);
    }
    scene_->set_samples(queue_, spp);
    return ended;
}

PathTracer::Ended PathTracer::render_bands(int spp, double slow_seconds, Picture &picture,
                                           RenderStats &stats) {
    paths_done_ = 0;
    film_->forget();
    picture.begin_again();
    for (const Band &band : bands_) {
        film_->begin(band);
        LaunchPlan plan = plan_of(band, spp);
        const Ended ended = run(plan, slow_seconds);
        if (ended == Ended::slow)
            return ended;
        take(picture, band, plan);
        add_counters(stats);
        if (ended == Ended::stopped)
            return ended;
    }
    return Ended::done;
}

bool PathTracer::render(int spp, Picture &picture, RenderStats &stats) {
    // A profile shows every sample once.
    const bool may_preview = spp >= least_spp_of_preview && !recorder_;
    bool preview_first = options_.preview || (may_preview && bands_.size() > 1);
    Ended ended = Ended::slow;
    while (ended == Ended::slow) {
        ended = preview_first ? preview(spp, picture, stats) : Ended::done;
        if (ended == Ended::done)
            ended = render_bands(spp, may_preview && !preview_first ? long_pass_seconds : no_limit,
                                 picture, stats);
        preview_first = true;
    }
    if (recorder_)
        recorder_->complete(spp);
    stats.paths = std::round(paths_done_);
    return ended == Ended::stopped;
}

void PathTracer::keep_work() {
    work_ = work();
    last_plan_.reset();
}

/// What is in the sums; a part of a block is not, as it lies beyond those that are set aside.
Work PathTracer::work() const {
    Work work = work_;
    if (last_plan_ && !is_beyond_)
        for (const WorkPiece &piece : last_plan_->work())
            work.push_back(piece);
    return joined(std::move(work));
}

PathTracer::Ended PathTracer::go_on(int done, int spp, double slow_seconds) {
    const bool is_whole = whole_blocks(spp) == spp;
    keep_work();
    if (done == 0) {
        work_.clear();
        film_->forget();
        film_->begin(bands_.front());
        progress_total_ = 1;
    } else if (is_beyond_) {
        film_->restore();
    }
    if (!is_whole && !(is_beyond_ && done > 0))
        film_->set_aside(context_);
    is_beyond_ = !is_whole;
    scene_->set_samples(queue_, spp);
    last_plan_.emplace(plan_of(bands_.front(), spp, blocks_of(done)));
    return run(*last_plan_, slow_seconds);
}

PathTracer::Ended PathTracer::add(Work pieces) {
    Ended ended = Ended::done;
    progress_total_ = 1;
    while (!pieces.empty() && ended == Ended::done) {
        // A plan takes a piece of each colour, of the same blocks.
        Work together = {pieces.front()};
        for (const WorkPiece &piece : pieces)
            if (piece.first_block == together[0].first_block &&
                piece.end_block == together[0].end_block && piece.colour > together.back().colour)
                together.push_back(piece);
        std::erase_if(pieces, [&](const WorkPiece &piece) {
            return std::find(together.begin(), together.end(), piece) != together.end();
        });
        keep_work();
        const int samples = CLR_BLOCK_START(together[0].end_block);
        scene_->set_samples(queue_, samples);
        last_plan_.emplace(plan_of(bands_.front(), samples, together[0].first_block));
        last_plan_->restrict_to(together);
        ended = run(*last_plan_, no_limit);
    }
    return ended;
}

FilmLayout PathTracer::layout(PixelFormat format) const {
    return {static_cast<int>(tiles_.width),
            static_cast<int>(tiles_.height),
            flat_.frame.film_exponent,
            config_.LANES,
            format,
            {tiles_.columns(), tiles_.rows(), config_.FILTER == CLR_FILTER_SPLATTED},
            control_,
            tiles_.measured};
}

void PathTracer::load(const Checkpoint &checkpoint) {
    if (!(checkpoint.layout == layout(checkpoint.layout.format)))
        throw DeviceError("the checkpoint's sums have another layout than this device's: expected "
                          "a device of the kind that has begun the render");
    film_->load(checkpoint.film, checkpoint.control);
    work_ = checkpoint.work;
    const int samples = samples_of(checkpoint);
    last_plan_.emplace(plan_of(bands_.front(), samples, blocks_of(samples)));
}

Checkpoint PathTracer::checkpoint(PixelFormat format) const {
    Checkpoint checkpoint;
    checkpoint.layout = layout(format);
    checkpoint.film.exponent = checkpoint.layout.exponent;
    film_->read_all(is_beyond_, checkpoint.film, checkpoint.control);
    checkpoint.work = work();
    return checkpoint;
}

int PathTracer::samples_of_all() const {
    return last_plan_ ? last_plan_->samples_of_all() : 0;
}

void PathTracer::read(Picture &picture, RenderStats &stats) {
    picture.begin_again();
    take(picture, bands_.front(), *last_plan_);
    // The counters go on from the first sample.
    stats.rays = stats.nonfinite_samples = 0;
    add_counters(stats);
    stats.paths = std::round(paths_done_);
}

void PathTracer::add_counters(RenderStats &stats) const {
    for (const ItemCounters &c : film_->read_counters()) {
        stats.rays += c.rays_low + 4294967296.0 * c.rays_high;
        if (c.nonfinite > 0 && stats.nonfinite_samples == 0) {
            stats.nonfinite_x =
                static_cast<int>(c.first_nonfinite % flat_.frame.width) - flat_.border;
            stats.nonfinite_y =
                static_cast<int>(c.first_nonfinite / flat_.frame.width) - flat_.border;
        }
        stats.nonfinite_samples += c.nonfinite;
    }
}

void PathTracer::complete_profile(const RenderStats &stats) {
    Profile &profile = *options_.profile;
    profile.device = stats.device;
    profile.config = config_;
    profile.uploaded_bytes = static_cast<double>(scene_->bytes());
    profile.device_bytes = static_cast<double>(stats.device_bytes);
    profile.downloaded_bytes += static_cast<double>(film_->bytes());
    profile.peak = measure_peak(entry_, context_, queue_);
}

} // namespace clrender::inline CLR_PRECISION
