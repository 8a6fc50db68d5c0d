#include "render_at_precision.h"

#include "film/film_blocks.h"
#include "film/trim.h"
#include "flatten/config_of.h"
#include "flatten/flat_scene.h"
#include "layer_passes.h"
#include "log.h"
#include "memory_need.h"
#include "path_tracer.h"
#include "profile.h"
#include "scene/limits.h"
#include "stopping_rule.h"

#include <chrono>
#include <fmt/core.h>
#include <limits>
#include <optional>
#include <utility>

namespace clrender::inline CLR_PRECISION {

namespace {

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

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A double-precision kernel has one lane.
int lanes_for(const DeviceEntry &entry, const RenderOptions &options) {
    if (CLR_DOUBLE != 0)
        return 1;
    return options.lanes > 0 ? options.lanes : natural_lanes(entry);
}

KernelConfig configure(const FlatScene &flat, const DeviceEntry &entry,
                       const RenderOptions &options) {
    ConfigOptions how;
    how.lanes = lanes_for(entry, options);
    how.tile = tile_for(entry);
    how.splat_filters = entry.is_cpu;
    how.bvh_step = bvh_step_for(entry);
    how.profile = options.profile != nullptr;
    how.variance = options.with_variance;
    return config_of(flat, options.sampling, how);
}

/// The group of tiles that share a control tile; independent samples need none.
std::size_t control_group_of(const FlatScene &flat, const KernelConfig &config) {
    if (config.VARIANCE == 0 || config.SAMPLER == CLR_SAMPLER_INDEPENDENT)
        return 0;
    return choose_control_group(
        {flat.frame.width, flat.frame.height, static_cast<std::size_t>(config.TILE)});
}

/// Values of each pixel: of the picture, and of the layers that are wanted.
std::size_t values_of(PixelFormat format, const RenderOptions &options) {
    return channels_of(format) * (options.with_variance ? 2 : 1) + (options.with_samples ? 1 : 0);
}

/// To be asked when the hierarchy is built. `values` of each pixel.
MemoryNeed need_of(const FlatScene &flat, const KernelConfig &config, const DeviceEntry &entry,
                   const RenderOptions &options, std::size_t values, bool to_compile) {
    const PictureTiles tiles = tiles_of(flat.frame, config);
    const ControlLayout control{tiles.width, tiles.height, tiles.side, flat.frame.control_group};
    return memory_need(
        entry, {flat.bytes(), largest_array_bytes(flat)},
        {band_bytes(tiles, bands_of(entry, tiles, options).front()), control.bytes()},
        tiles.pixels() * values * sizeof(float), to_compile);
}

void warn_of_samples(const RenderStats &stats) {
    if (stats.nonfinite_samples > 0)
        log::warn(fmt::format("{} samples were not finite and count as black; the first in pixel "
                              "({}, {})",
                              stats.nonfinite_samples, stats.nonfinite_x, stats.nonfinite_y));
    if (stats.clamped_pixels > 0)
        log::warn(fmt::format("{} pixels had sums beyond the film's range, which were clamped; the "
                              "first is ({}, {})",
                              stats.clamped_pixels, stats.clamped_x, stats.clamped_y));
}

DeviceEntry choose_device_for(const RenderOptions &options) {
    DeviceEntry entry = choose_device(options.device);
    log::detail(fmt::format("device: {} ({})", entry.name, entry.platform));
    if (CLR_DOUBLE != 0 && !entry.has_double)
        throw DeviceError(fmt::format("{} has no double precision (cl_khr_fp64)", entry.name));
    return entry;
}

/// A scene on the device, and the picture that becomes of it.
class Rendering : public AdvancingRender {
public:
    /// Flattens, compiles and uploads. Frees the shapes and images of the scene on the way.
    Rendering(Scene &&scene, const RenderOptions &options);

    /// Renders as the options say, in bands where the picture is large. Not together with
    /// advance().
    void render_all();
    bool advance(int samples) override;
    [[nodiscard]] int samples() const override { return done_; }
    RenderResult read() override;
    /// The last picture; takes it away.
    RenderResult finish();
    /// What is left for the profile, if there is one, after all else.
    void complete_profile();
    [[nodiscard]] bool in_one_piece() const { return tracer_->in_one_piece(); }

private:
    void set_frame();
    void report_to(const RenderOptions &options);
    void render_by_rules();
    PathTracer::Ended begin_with_work();
    void write_checkpoint();
    void measure_error(StoppingRule &rule);
    void set_finish_seconds(StoppingRule &rule);
    void read_film() { tracer_->read(*picture_, stats_); }
    [[nodiscard]] double now() const { return seconds_since(origin_); }
    RenderResult result_of(Picture &&picture);

    RenderOptions options_;
    Stopwatch watch_;
    DeviceEntry entry_;
    int spp_;
    FlatScene flat_;
    KernelConfig config_;
    RenderStats stats_;
    std::unique_ptr<PathTracer> tracer_;
    std::unique_ptr<LayerPasses> layers_; ///< where layers are wanted
    RenderResult layer_result_;           ///< of these
    std::unique_ptr<Picture> picture_;
    std::optional<StoppingRule> rule_; ///< where samples alone do not end the render
    const std::chrono::steady_clock::time_point origin_ = std::chrono::steady_clock::now();
    double render_start_ = 0; ///< by now()
    double paths_before_ = 0; ///< of the steps before this one
    int done_ = 0;
    bool stopped_ = false;
    bool has_picture_ = false; ///< every pixel has had a sample
    PixelFormat format_;
};

Rendering::Rendering(Scene &&scene, const RenderOptions &options)
    : options_(options), watch_(options.profile), entry_(choose_device_for(options)),
      spp_(options.spp > 0 ? options.spp : scene.sample_count) {
    stats_.seconds_device = watch_.lap("open the device");
    report_to(options);
    const PixelFormat format = format_ = scene.film.pixel_format;
    const std::size_t values = values_of(format, options_) + layer_values(scene, options_);
    options_.sampling.first_hits = wants_layers(scene, options_);
    flat_ = flatten(scene, options_.sampling);
    if (options_.sampling.first_hits)
        layers_ = std::make_unique<LayerPasses>(scene, flat_, options_, spp_);
    scene = {};
    config_ = configure(flat_, entry_, options_);
    set_frame();

    // The kernel is compiled while the hierarchy is being built.
    tracer_ = std::make_unique<PathTracer>(entry_, flat_, config_, options_);
    tracer_->start_compiling();
    if (options_.write_checkpoint)
        tracer_->on_checkpoint(options_.checkpoint_due, [this] { write_checkpoint(); });
    if (layers_)
        layers_->start_compiling(tracer_->context(), tracer_->queue(), entry_, config_);
    build_hierarchy(flat_);
    stats_.host_bytes = flat_.bytes();
    stats_.seconds_build = watch_.lap("build");
    tracer_->compile(stats_);
    stats_.seconds_compile = watch_.lap("compile");
    check_memory_need(need_of(flat_, config_, entry_, options_, values, false), entry_);
    tracer_->upload(stats_);
    stats_.seconds_upload = watch_.lap("upload");
    picture_ =
        std::make_unique<Picture>(tiles_of(flat_.frame, config_), format,
                                  Picture::Layers{options_.with_variance, options_.with_samples},
                                  flat_.frame.film_exponent, tracer_->control_layout());
}

/// What the render decides of the frame.
void Rendering::set_frame() {
    FrameData &frame = flat_.frame;
    frame.seed = options_.seed;
    frame.total_samples = static_cast<uint>(spp_);
    frame.control_group = static_cast<uint>(control_group_of(flat_, config_));
    stats_.device = entry_.name;
    stats_.lanes = config_.LANES;
    stats_.width = static_cast<int>(frame.width) - 2 * flat_.border;
    stats_.height = static_cast<int>(frame.height) - 2 * flat_.border;
    stats_.spp = spp_;
    stats_.triangles = flat_.triangle_count;
}

/// Completes what is told of the progress, and stops a render that would be late.
void Rendering::report_to(const RenderOptions &options) {
    if (options.on_progress)
        options_.on_progress = [this, tell = options.on_progress](RenderProgress progress) {
            const auto pixels = static_cast<double>(flat_.frame.width) * flat_.frame.height;
            const double seconds = now() - render_start_;
            progress.most_samples = spp_ < max_sample_count ? spp_ : 0;
            if (rule_) {
                progress.samples = rule_->whole() + (progress.paths - paths_before_) / pixels;
                progress.seconds_left = rule_->seconds_left(now(), progress.samples);
                progress.error = rule_->law().error_at(progress.samples);
                progress.fraction = seconds / (seconds + progress.seconds_left);
            } else {
                progress.samples = progress.paths / pixels;
                progress.fraction = std::min(progress.samples / spp_, 1.0);
                progress.seconds_left = seconds * (1 / progress.fraction - 1);
            }
            tell(progress);
        };
    options_.should_stop = [this, stop = options.should_stop] {
        return (stop && stop()) || (rule_ && rule_->is_overdue(now()));
    };
}

void Rendering::render_all() {
    // First, since they take little: a render that is stopped has them.
    if (layers_) {
        layers_->run(tracer_->scene(), flat_, layer_result_);
        layers_.reset();
        watch_.lap("layers");
    }
    const bool is_timed = options_.deadline != std::chrono::steady_clock::time_point{};
    render_start_ = now();
    if (is_timed || options_.target_error > 0 || options_.write_checkpoint || options_.resumed) {
        if (!in_one_piece())
            throw DeviceError("the picture is so large that it is rendered in bands, where only a "
                              "number of samples can end the render, without checkpoints");
        StopLimits limits{.samples = spp_, .error = options_.target_error};
        if (is_timed)
            limits.deadline = std::chrono::duration<double>(options_.deadline - origin_).count();
        rule_.emplace(limits);
        render_by_rules();
    } else {
        stopped_ = tracer_->render(spp_, *picture_, stats_);
        done_ = stopped_ ? 0 : spp_;
    }
    stats_.seconds_render = watch_.lap("render") - tracer_->seconds_read();
}

/// The work that does not lie in steps: what a checkpoint lacks of its blocks, and a part.
PathTracer::Ended Rendering::begin_with_work() {
    Work done;
    if (options_.resumed) {
        tracer_->load(*options_.resumed);
        done = options_.resumed->work;
        for (const FilmPixel &pixel : options_.resumed->film.pixels)
            stats_.paths_before += pixel.samples;
    }
    const WorkGrid grid = tracer_->layout(format_).grid;
    int end = 0;
    for (const WorkPiece &piece : done)
        end = std::max(end, piece.end_block);
    const Work wanted = options_.parts > 1
                            ? part_of_work(grid, blocks_of(spp_), options_.part, options_.parts)
                            : all_work(grid, 0, end);
    const auto ended = tracer_->add(missing_work(wanted, done));
    paths_before_ = tracer_->paths();
    if (ended == PathTracer::Ended::done && end > 0 && options_.parts == 1) {
        rule_->go_on_from(CLR_BLOCK_START(end));
        if (options_.target_error > 0)
            measure_error(*rule_);
    }
    return ended;
}

/// Step by step, as the rules have it.
void Rendering::render_by_rules() {
    StoppingRule &rule = *rule_;
    auto ended = begin_with_work();
    while (ended != PathTracer::Ended::stopped && options_.parts == 1) {
        const auto step = rule.next(now());
        if (!step)
            break;
        const double start = now();
        // What is rendered again stays in the picture until it has been.
        if (rule.shown() > rule.whole() && !step->measure)
            read_film();
        ended = tracer_->go_on(rule.whole(), step->samples, step->slow_seconds);
        if (ended == PathTracer::Ended::stopped)
            break;
        paths_before_ = tracer_->paths();
        if (ended == PathTracer::Ended::slow) {
            rule.too_slow();
            continue;
        }
        rule.rendered(*step, now() - start);
        if (step->measure)
            measure_error(rule);
        if (!std::exchange(has_picture_, true))
            set_finish_seconds(rule);
    }
    stats_.spp = options_.parts > 1 ? spp_ : rule.shown();
    if (ended == PathTracer::Ended::stopped) {
        stats_.spp = std::max(rule.shown(), tracer_->samples_of_all());
        stopped_ = !rule.is_overdue(now());
        rule.overdue();
    }
    read_film();
    done_ = rule.whole();
    if (options_.write_checkpoint)
        write_checkpoint();
}

void Rendering::write_checkpoint() {
    read_film();
    const RenderResult result = result_of(Picture(*picture_));
    options_.write_checkpoint(tracer_->checkpoint(format_), result.image);
}

void Rendering::measure_error(StoppingRule &rule) {
    read_film();
    rule.measured(read().error.relative_error());
}

/// What it takes to read the film is measured at the first picture; what it takes to write it is
/// asked for.
void Rendering::set_finish_seconds(StoppingRule &rule) {
    if (options_.deadline == std::chrono::steady_clock::time_point{})
        return;
    const double start = now();
    read_film();
    const RenderResult result = read();
    const double read_seconds = now() - start;
    const double write_seconds =
        options_.seconds_to_write ? options_.seconds_to_write(result.image) : 0;
    log::detail(fmt::format("for the deadline: reading the film takes {:.3f} s, writing {:.3f} s",
                            read_seconds, write_seconds));
    const double checkpoint_start = now();
    if (options_.write_checkpoint)
        write_checkpoint(); // one more comes at the end
    rule.set_finish_seconds(read_seconds + write_seconds + now() - checkpoint_start);
}

bool Rendering::advance(int samples) {
    const int end = std::min(whole_blocks(samples), spp_);
    if (stopped_)
        return false;
    if (end <= done_)
        return true;
    stopped_ = tracer_->go_on(done_, end) != PathTracer::Ended::done;
    read_film();
    stats_.seconds_render += watch_.lap("render");
    if (!stopped_)
        stats_.spp = done_ = end;
    return !stopped_;
}

RenderResult Rendering::read() {
    return result_of(Picture(*picture_));
}

/// The layers are moved into the last result alone: checkpoints and measurements of a render on its
/// way have the picture only.
RenderResult Rendering::finish() {
    RenderResult result = result_of(std::move(*picture_));
    result.layers = std::move(layer_result_.layers);
    result.layer_metadata = std::move(layer_result_.layer_metadata);
    return result;
}

RenderResult Rendering::result_of(Picture &&picture) {
    RenderResult result;
    result.interrupted = stopped_;
    if (rule_)
        result.ended_by = rule_->reason();
    if (stopped_)
        result.gaps = picture.fill_gaps();
    stats_.clamped_pixels = picture.clamped.count;
    stats_.clamped_x = static_cast<int>(picture.clamped.first % flat_.frame.width) - flat_.border;
    stats_.clamped_y = static_cast<int>(picture.clamped.first / flat_.frame.width) - flat_.border;
    result.stats = stats_;
    result.image = std::move(picture.image);
    result.samples = std::move(picture.samples);
    result.variance = std::move(picture.variance);
    if (options_.with_variance) {
        const std::vector<ControlPixel> pixels = tracer_->read_control();
        result.error.factor = variance_factor(
            {tracer_->control_layout(), pixels, picture.control_means, flat_.frame.film_exponent},
            result.image, result.variance);
        for (float &value : result.variance.f32)
            value *= static_cast<float>(result.error.factor.value);
    }
    for (Image *image : {&result.image, &result.samples, &result.variance})
        trim(*image, flat_.border);
    if (options_.with_variance)
        result.error.relative_variance =
            result.gaps > 0 ? std::numeric_limits<double>::infinity()
                            : mean_relative_variance(result.image, result.variance);
    return result;
}

void Rendering::complete_profile() {
    if (options_.profile == nullptr)
        return;
    tracer_->complete_profile(stats_);
    watch_.lap("measure peak");
}

/// A scene can be checked where there is no device: it will be a CPU's, and large.
DeviceEntry device_or_large_cpu(const std::string &spec) {
    try {
        return choose_device(spec);
    } catch (const DeviceError &) {
        DeviceEntry entry;
        entry.is_cpu = true;
        entry.max_allocation_bytes = entry.memory_bytes = std::numeric_limits<std::size_t>::max();
        return entry;
    }
}

} // namespace

MemoryNeed memory_at_precision(Scene &&scene, const RenderOptions &options) {
    const DeviceEntry entry = device_or_large_cpu(options.device);
    SamplingOptions sampling = options.sampling;
    sampling.first_hits = wants_layers(scene, options);
    FlatScene flat = flatten(scene, sampling);
    const KernelConfig config = configure(flat, entry, options);
    const std::size_t values =
        values_of(scene.film.pixel_format, options) + layer_values(scene, options);
    scene = {};
    build_hierarchy(flat);
    flat.frame.control_group = static_cast<uint>(control_group_of(flat, config));
    return need_of(flat, config, entry, options, values, true);
}

RenderResult render_at_precision(Scene &&scene, const RenderOptions &options) {
    Rendering rendering(std::move(scene), options);
    rendering.render_all();
    RenderResult result = rendering.finish();
    rendering.complete_profile();
    warn_of_samples(result.stats);
    return result;
}

std::unique_ptr<AdvancingRender> start_at_precision(Scene &&scene, const RenderOptions &options) {
    auto rendering = std::make_unique<Rendering>(std::move(scene), options);
    if (!rendering->in_one_piece())
        throw DeviceError("the picture is too large to be looked at while it is rendered: its sums "
                          "do not fit on the device in one piece");
    return rendering;
}

} // namespace clrender::inline CLR_PRECISION
