/// clrender: from a scene file to a picture. Each arrow of the way is one call here.

#include "cli/compare.h"
#include "cli/interrupt.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "cli/stats_file.h"
#include "device/cl_context.h"
#include "error.h"
#include "log.h"
#include "render/profile.h"
#include "render/profile_trace.h"
#include "render/render.h"
#include "scene/load_scene.h"

#include <chrono>
#include <exception>
#include <fmt/core.h>
#include <utility>

using namespace clrender;

namespace {

constexpr int exit_input = 2;
constexpr int exit_device = 3;
constexpr int exit_signal = 128; ///< plus the signal's number

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

int show_devices() {
    const std::vector<DeviceEntry> devices = list_devices();
    for (const DeviceEntry &d : devices)
        fmt::print("{}: {} ({}, {}, {} compute units, {:.1f} GiB)\n", d.index, d.name, d.platform,
                   d.is_gpu ? "GPU" : (d.is_cpu ? "CPU" : "other"), d.compute_units,
                   static_cast<double>(d.memory_bytes) / (1 << 30));
    if (devices.empty())
        choose_device("auto");
    return 0;
}

/// What the command line says overrides what the scene says.
void apply_options(const cli::Options &options, Scene &scene) {
    if (options.spp)
        scene.sample_count = *options.spp;
    if (options.max_depth)
        scene.integrator.max_depth = *options.max_depth;
    if (options.rr_depth)
        scene.integrator.rr_depth = *options.rr_depth;
    if (options.resolution) {
        scene.film.width = scene.film.crop_width = options.resolution->width;
        scene.film.height = scene.film.crop_height = options.resolution->height;
        scene.film.crop_x = scene.film.crop_y = 0;
    }
}

RenderOptions render_options(const cli::Options &options, cli::Progress &progress,
                             Profile &profile) {
    RenderOptions r;
    r.seed = options.seed.value_or(0);
    r.lanes = options.lanes;
    r.device = options.device;
    r.brute_force = options.accel == cli::Accel::none;
    r.pixel_centers = options.pixel_centers;
    r.independent_sampler = options.independent;
    r.strategy = options.strategy;
    r.light_samples = options.light_samples;
    r.batch = options.batch;
    r.tile = options.tile;
    r.generality = options.generality;
    r.kernel_dir = options.kernel_dir;
    r.profile = options.profile ? &profile : nullptr;
    r.band_rows = options.band_rows;
    r.preview = options.preview;
    r.on_progress = [&](double paths) {
        cli::keep_picture();
        progress.update(paths);
    };
    r.should_stop = [] { return cli::interrupted() != 0; };
    return r;
}

std::map<std::string, std::string> metadata(const cli::Options &options, const std::string &scene,
                                            const RenderStats &stats) {
    return {{"scene", scene},
            {"samples", std::to_string(stats.spp)},
            {"seed", std::to_string(options.seed.value_or(0))},
            {"version", CLRENDER_VERSION},
            {"device", stats.device}};
}

int render_command(const cli::Options &options) {
    cli::catch_interrupts();
    Profile profile;
    const auto start = profile.origin;
    Scene scene = load_scene(options.scene, {options.defines});
    apply_options(options, scene);
    cli::RunTimes times;
    times.parse = seconds_since(start);
    profile.add_phase("parse", start, std::chrono::steady_clock::now());
    cli::Progress progress(static_cast<double>(scene.film.crop_width) * scene.film.crop_height *
                               scene.sample_count,
                           scene.sample_count, !options.quiet && !options.check);
    const RenderOptions how = render_options(options, progress, profile);
    if (options.check) {
        if (!options.stats.empty() || options.profile)
            log::warn("--check renders nothing: --stats and --profile are left out");
        log::info(fmt::format(
            "{}: fine: {} shapes, {} emitters, {}x{} pixels, {} samples, {:.2f} MiB on the device",
            options.scene, scene.shapes.size(), scene.emitters.size(), scene.film.crop_width,
            scene.film.crop_height, scene.sample_count,
            static_cast<double>(device_bytes_needed(scene, how)) / (1 << 20)));
        return 0;
    }

    const std::string name = scene.name;
    const RenderResult result = render_scene(std::move(scene), how);
    progress.finish();

    const auto write_start = std::chrono::steady_clock::now();
    for (const std::string &path : options.outputs)
        write_image(path, result.image, options.exposure, metadata(options, name, result.stats));
    times.write = seconds_since(write_start);
    profile.add_phase("write", write_start, std::chrono::steady_clock::now());
    times.total = seconds_since(start);
    if (!options.stats.empty())
        cli::write_stats(options.stats, result, times);
    log::info(cli::summary(result, times, options.outputs));
    if (options.profile)
        fmt::print("{}", profile_table(profile));
    if (!options.profile_trace.empty())
        write_profile_trace(options.profile_trace, profile);
    return result.interrupted ? exit_signal + cli::interrupted() : 0;
}

int run(const cli::Options &options) {
    if (options.quiet)
        log::set_level(log::Level::quiet);
    else if (options.verbose)
        log::set_level(log::Level::verbose);
    switch (options.command) {
    case cli::Command::list_devices:
        return show_devices();
    case cli::Command::compare:
        return compare_command(options.compare.a, options.compare.b, options.compare.tolerance);
    case cli::Command::render:
        break;
    }
    return render_command(options);
}

} // namespace

int main(int argc, char **argv) {
    try {
        const cli::ParseResult parsed = cli::parse_options(argc, argv);
        return parsed.options ? run(*parsed.options) : parsed.exit_code;
    } catch (const InputError &e) {
        fmt::print(stderr, "{}\n", e.what());
        return exit_input;
    } catch (const DeviceError &e) {
        fmt::print(stderr, "clrender: {}\n", e.what());
        return exit_device;
    } catch (const std::bad_alloc &) {
        fmt::print(stderr, "clrender: out of memory\n");
        return exit_input;
    } catch (const std::exception &e) {
        fmt::print(stderr, "clrender: {}\n", e.what());
        return exit_device;
    }
}
