#include "render_at_precision.h"

#include "flatten/flat_scene.h"
#include "log.h"
#include "path_tracer.h"
#include "profile.h"

#include <chrono>
#include <fmt/core.h>
#include <limits>
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

FlattenOptions flatten_options(const RenderOptions &options) {
    FlattenOptions flatten_options;
    flatten_options.brute_force = options.brute_force;
    flatten_options.pixel_centers = options.pixel_centers;
    flatten_options.strategy = options.strategy;
    flatten_options.light_samples = options.light_samples;
    flatten_options.generality = options.generality;
    return flatten_options;
}

/// Compiles, uploads and renders; `flat` is all that is needed of the scene.
RenderResult render_flat(FlatScene flat, const FilmSettings &film, int spp,
                         const RenderOptions &options, const DeviceEntry &entry, Stopwatch &watch,
                         double seconds_device) {
    RenderResult result;
    RenderStats &stats = result.stats;
    stats.device = entry.name;
    stats.seconds_device = seconds_device;
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
    // Before the upload, which frees the table.
    std::vector<double> spread{1.0};
    if (flat.config.BORDER > 0)
        spread = filter_spread(flat.filter, double{flat.frame.filter_radius}, flat.config.BORDER);
    tracer.upload(stats);
    stats.seconds_upload = watch.lap("upload");
    Picture picture(tiles_of(flat), film.pixel_format, options.with_variance,
                    flat.frame.film_exponent, std::move(spread));
    result.interrupted = tracer.render(spp, picture, stats);
    stats.seconds_render = watch.lap("render") - tracer.seconds_read();
    if (result.interrupted)
        result.gaps = picture.fill_gaps();
    stats.clamped_pixels = picture.clamped.count;
    stats.clamped_x = static_cast<int>(picture.clamped.first % flat.frame.width);
    stats.clamped_y = static_cast<int>(picture.clamped.first / flat.frame.width);
    result.image = std::move(picture.image);
    result.variance = std::move(picture.variance);
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

} // namespace

std::size_t device_bytes_at_precision(const Scene &scene, const RenderOptions &options) {
    FlatScene flat = flatten(scene, flatten_options(options));
    build_hierarchy(flat);
    flat.config.TILE = CLR_LEAST_TILE;
    DeviceEntry entry;
    try {
        entry = choose_device(options.device);
        flat.config.TILE = tile_of(entry, flat.config);
    } catch (const DeviceError &) {
        // A scene can be checked where there is no device: it will be one like this, and large.
        entry.max_allocation_bytes = entry.memory_bytes = std::numeric_limits<std::size_t>::max();
    }
    return flat.bytes() + band_bytes(tiles_of(flat), bands_of(entry, flat, options).front());
}

RenderResult render_at_precision(Scene &&scene, const RenderOptions &options) {
    Stopwatch watch(options.profile);
    const DeviceEntry entry = choose_device(options.device);
    const double seconds_device = watch.lap("open the device");
    log::detail(fmt::format("device: {} ({})", entry.name, entry.platform));
    if (CLR_DOUBLE != 0 && !entry.has_double)
        throw DeviceError(fmt::format("{} has no double precision (cl_khr_fp64)", entry.name));
    const int spp = options.spp > 0 ? options.spp : scene.sample_count;
    const FilmSettings film = scene.film;
    FlatScene flat = flatten(scene, flatten_options(options));
    scene = {};
    return render_flat(std::move(flat), film, spp, options, entry, watch, seconds_device);
}

} // namespace clrender::inline CLR_PRECISION
