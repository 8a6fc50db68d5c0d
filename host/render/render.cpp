#include "render_at_precision.h"

#include "flatten/flat_scene.h"
#include "log.h"
#include "path_tracer.h"
#include "profile.h"

#include <chrono>
#include <fmt/core.h>

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

FlattenOptions flatten_options(const RenderOptions &options) {
    FlattenOptions flatten_options;
    flatten_options.brute_force = options.brute_force;
    flatten_options.pixel_centers = options.pixel_centers;
    flatten_options.strategy = options.strategy;
    flatten_options.light_samples = options.light_samples;
    flatten_options.generality = options.generality;
    return flatten_options;
}

} // namespace

std::size_t device_bytes_at_precision(const Scene &scene, const RenderOptions &options) {
    FlatScene flat = flatten(scene, flatten_options(options));
    build_hierarchy(flat);
    int tile = CLR_LEAST_TILE;
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
    // Independent samples need no control.
    if (options.with_variance && !options.independent_sampler)
        flat.frame.control_group = static_cast<uint>(choose_control_group(
            {flat.frame.width, flat.frame.height, static_cast<std::size_t>(flat.config.TILE)}));
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
    result.interrupted = tracer.render(spp);
    stats.seconds_render = watch.lap("render");
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
    if (stats.clamped_pixels > 0)
        log::warn(fmt::format("{} pixels had sums beyond the film's range, which were clamped; the "
                              "first is ({}, {})",
                              stats.clamped_pixels, stats.clamped_x, stats.clamped_y));
    return result;
}

} // namespace clrender::inline CLR_PRECISION
