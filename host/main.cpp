/// clrender: from a scene file to a picture. Each arrow of the way is one call here.

#include "cli/checkpointing.h"
#include "cli/compare.h"
#include "cli/exit_codes.h"
#include "cli/interrupt.h"
#include "cli/options.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "cli/stats_file.h"
#include "cli/test_command.h"
#include "device/cl_context.h"
#include "error.h"
#include "film/checkpoint.h"
#include "film/film_blocks.h"
#include "log.h"
#include "memory_limit.h"
#include "print.h"
#include "render/inner_pictures.h"
#include "render/profile.h"
#include "render/profile_trace.h"
#include "render/render.h"
#include "scene/aov.h"
#include "scene/film_border.h"
#include "scene/limits.h"
#include "scene/load_scene.h"
#include "selftest/self_test.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fmt/core.h>
#include <future>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

using namespace clrender;

namespace {

/// What the run is at, for the message where it ends unexpectedly.
std::string activity = "reading the command line";

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

int show_devices() {
    const std::vector<DeviceEntry> devices = list_devices();
    for (const DeviceEntry &d : devices)
        print("{}: {} ({}, {}, {} compute units, {:.1f} GiB)\n", d.index, d.name, d.platform,
              d.is_gpu ? "GPU" : (d.is_cpu ? "CPU" : "other"), d.compute_units,
              static_cast<double>(d.memory_bytes) / (1 << 30));
    if (devices.empty())
        choose_device("auto");
    return 0;
}

/// What the command line says overrides what the scene says.
void apply_options(const cli::Options &options, Scene &scene) {
    // Rules of the command line take the place of the scene's number of samples.
    if (options.spp)
        scene.sample_count = *options.spp;
    else if (options.stop.any())
        scene.sample_count = max_sample_count;
    if (options.max_depth)
        scene.integrator.max_depth = *options.max_depth;
    if (options.weight_window)
        scene.integrator.rr_depth.reset();
    if (options.rr_depth)
        scene.integrator.rr_depth = *options.rr_depth;
    if (options.resolution) {
        scene.film.width = scene.film.crop_width = options.resolution->width;
        scene.film.height = scene.film.crop_height = options.resolution->height;
        scene.film.crop_x = scene.film.crop_y = 0;
    }
}

/// The layers of --aov that tell what the camera sees first.
std::vector<Aov> aovs_of(const std::set<std::string> &layers) {
    static const std::map<std::string, AovType> special = {{"albedo", AovType::reflectance},
                                                           {"normal", AovType::sh_normal},
                                                           {"depth", AovType::camera_depth}};
    std::vector<Aov> aovs;
    for (const std::string &layer : layers) {
        const auto found = special.find(layer);
        if (const auto type = found != special.end() ? found->second : aov_type_of(layer))
            aovs.push_back({layer, *type});
    }
    return aovs;
}

RenderOptions render_options(const cli::Options &options, cli::Progress &progress,
                             Profile &profile) {
    RenderOptions r;
    r.seed = options.seed.value_or(0);
    r.lanes = options.lanes;
    r.double_precision = options.double_precision;
    r.device = options.device;
    r.sampling = options.sampling;
    r.batch = options.batch;
    r.tile = options.tile;
    r.kernel_dir = options.kernel_dir;
    r.target_error = options.stop.error.value_or(0);
    r.with_variance = options.layers.count("variance") != 0 || options.stop.error;
    r.with_samples = options.layers.count("samples") != 0;
    r.layers.aovs = aovs_of(options.layers);
    r.layers.matte = options.layers.count("cryptomatte") != 0;
    r.profile = options.profile ? &profile : nullptr;
    r.band_rows = options.band_rows;
    r.preview = options.preview;
    r.on_progress = [&](const RenderProgress &now) {
        cli::keep_picture();
        progress.update(now);
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

/// What a picture's file format cannot hold is told before the picture is made.
void check_outputs(const cli::Options &options, const Scene &scene) {
    constexpr int most_channels = 4;
    const auto holds_layers = [](const std::string &path) {
        return std::filesystem::path(path).extension() == ".exr";
    };
    std::set<std::string> layers = options.layers;
    if (!options.checkpoint.file.empty())
        layers.erase("variance"); // which the checkpoint has
    if (!layers.empty() &&
        std::none_of(options.outputs.begin(), options.outputs.end(), holds_layers))
        log::warn("the layers of --aov are left out: they need a picture as an .exr file (-o)");
    for (const std::string &path : options.outputs) {
        const std::string reason =
            why_too_large(path, scene.film.crop_width, scene.film.crop_height, most_channels);
        if (!reason.empty())
            throw InputError({path, 0}, reason);
    }
}

/// Writes the pictures; none is left out because another cannot be written. Those of up to 2^24
/// pixels are encoded side by side, larger ones one after the other, so that no two lie in memory
/// as bytes. A stopped render is written fast.
void write_pictures(const cli::Options &options, const std::string &scene,
                    const RenderResult &result, cli::Outputs &outputs) {
    auto about = metadata(options, scene, result.stats);
    about.insert(result.layer_metadata.begin(), result.layer_metadata.end());
    std::vector<ImageLayer> layers;
    if (options.layers.count("variance") != 0)
        layers.push_back({"variance", &result.variance});
    if (options.layers.count("samples") != 0)
        layers.push_back({"samples", &result.samples});
    std::set<std::string> channels;
    for (const NamedLayer &layer : result.layers) {
        if (channels.insert(layer.channels.front()).second)
            layers.push_back({"", &layer.image, layer.channels});
        else
            log::warn("the layer with the channel " + layer.channels.front() +
                      " is left out: the scene has one of that name");
    }
    const bool is_large = std::int64_t{result.image.width} * result.image.height > 1 << 24;
    std::vector<std::future<void>> writes;
    for (const std::string &path : options.outputs)
        writes.push_back(std::async(is_large ? std::launch::deferred : std::launch::async, [&,
                                                                                            path] {
            write_image(path, result.image, options.exposure, about, layers, result.interrupted);
        }));
    for (std::size_t i = 0; i < writes.size(); ++i)
        outputs.attempt(options.outputs[i], [&] { writes[i].get(); });
    if (outputs.written().empty())
        outputs.rescue(scene, result.image, about);
}

/// What writing the pictures will take, from that of a part of them: its middle rows.
double seconds_to_write(const cli::Options &options, const Image &image) {
    constexpr int pixels = 1 << 16;
    const Image part = middle_rows(image, std::max(pixels / image.width, 1));
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::future<void>> writes;
    for (const std::string &path : options.outputs)
        writes.push_back(std::async(std::launch::async,
                                    [&, path] { try_write_image(path, part, options.exposure); }));
    for (std::future<void> &write : writes)
        write.get();
    return seconds_since(start) * image.height / part.height;
}

/// Makes the render write checkpoints, and go on from `resumed`, if there is one.
void add_checkpoints(const cli::Options &options, const Scene &scene,
                     const std::shared_ptr<const Checkpoint> &resumed, RenderOptions &how,
                     std::optional<cli::CheckpointWriter> &writer) {
    const cli::CheckpointOptions &checkpoint = options.checkpoint;
    if (sampled_border(scene.film) > 0)
        throw InputError({options.scene, 0},
                         "the film has a sample_border, expected none beside --checkpoint");
    if (checkpoint.parts > 1 && whole_blocks(scene.sample_count) != scene.sample_count)
        throw InputError({options.scene, 0},
                         fmt::format("{} samples cannot be dealt to parts, expected 16, 32 or a "
                                     "multiple of 64 (-s)",
                                     scene.sample_count));
    cli::Options run = options;
    if (!options.stop.any())
        run.spp = scene.sample_count;
    const std::string described = cli::describe_run(run);
    if (resumed) {
        cli::check_same_run(checkpoint.resumed, resumed->options, options.scene, described);
        // The shares of fewer blocks than parts are others than those of more.
        if (checkpoint.parts > 1 &&
            !missing_work(resumed->work,
                          part_of_work(resumed->layout.grid, blocks_of(scene.sample_count),
                                       checkpoint.part, checkpoint.parts))
                 .empty())
            throw InputError(
                {checkpoint.resumed, 0},
                fmt::format("has samples that are not of part {} of {} of {} samples, expected the "
                            "number that it was begun with",
                            checkpoint.part, checkpoint.parts, scene.sample_count));
    }
    writer.emplace(checkpoint, described);
    how.resumed = resumed;
    how.part = checkpoint.part;
    how.parts = checkpoint.parts;
    how.checkpoint_due = [&writer] { return writer->is_due(); };
    how.write_checkpoint = [&writer, &options, name = scene.name](const Checkpoint &sums,
                                                                  const Image &picture) {
        RenderStats stats;
        stats.spp = samples_of(sums);
        writer->write(sums, picture, metadata(options, name, stats));
    };
}

int render_command(const cli::Options &options,
                   const std::shared_ptr<const Checkpoint> &resumed = nullptr) {
    cli::catch_interrupts();
    Profile profile;
    const auto start = profile.origin;
    activity = "reading " + options.scene;
    Scene scene = load_scene(options.scene, {options.defines, options.sensor, options.check});
    apply_options(options, scene);
    check_outputs(options, scene);
    cli::RunTimes times;
    times.parse = seconds_since(start);
    profile.add_phase("parse", start, std::chrono::steady_clock::now());
    cli::Progress progress(!options.quiet && !options.check);
    RenderOptions how = render_options(options, progress, profile);
    if (options.stop.seconds)
        how.deadline = start + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                   std::chrono::duration<double>(*options.stop.seconds));
    how.seconds_to_write = [&](const Image &image) { return seconds_to_write(options, image); };
    std::optional<cli::CheckpointWriter> checkpoints;
    if (!options.checkpoint.file.empty() && !options.check)
        add_checkpoints(options, scene, resumed, how, checkpoints);
    activity = options.check ? "checking " + options.scene : "rendering " + options.scene;
    if (options.check) {
        if (!options.stats.empty() || options.profile)
            log::warn("--check renders nothing: --stats and --profile are left out");
        const std::string instances =
            scene.instances.empty() ? "" : fmt::format("{} instances, ", scene.instances.size());
        const std::string what =
            fmt::format("{}: fine: {} shapes, {}{} emitters, {}x{} pixels, {} samples",
                        options.scene, scene.shapes.size(), instances, scene.emitters.size(),
                        scene.film.crop_width, scene.film.crop_height, scene.sample_count);
        const MemoryNeed need = memory_needed(std::move(scene), how);
        log::info(fmt::format("{}, {:.2f} MiB on the device, {:.0f} MiB in all", what,
                              static_cast<double>(need.device) / (1 << 20),
                              static_cast<double>(need.process) / (1 << 20)));
        return 0;
    }

    const std::string name = scene.name;
    RenderResult result = render_with_inner_pictures(std::move(scene), how);
    // Beside a large picture it would be most of the memory.
    if (options.layers.count("variance") == 0)
        result.variance = Image();
    progress.finish();

    activity = "writing the pictures";
    const auto write_start = std::chrono::steady_clock::now();
    cli::Outputs outputs;
    if (!options.outputs.empty())
        write_pictures(options, name, result, outputs);
    if (checkpoints)
        outputs.attempt(options.checkpoint.file, [&] { checkpoints->check(); });
    times.write = seconds_since(write_start);
    profile.add_phase("write", write_start, std::chrono::steady_clock::now());
    times.total = seconds_since(start);
    log::info(cli::summary(result, times, outputs.written()));
    if (options.stop.any())
        log::info(cli::reason_line(result, times));

    activity = "writing what is known of the run";
    if (!options.stats.empty())
        outputs.attempt(options.stats, [&] { cli::write_stats(options.stats, result, times); });
    if (!options.profile_trace.empty())
        outputs.attempt(options.profile_trace,
                        [&] { write_profile_trace(options.profile_trace, profile); });
    if (options.profile)
        print("{}", profile_table(profile));
    if (!outputs.report())
        return cli::exit_output;
    return result.interrupted ? cli::exit_signal + cli::interrupted() : cli::exit_fine;
}

int test_command(const cli::Options &options) {
    cli::catch_interrupts();
    Profile profile;
    activity = "reading " + options.scene;
    Scene scene = load_scene(options.scene, {options.defines, options.sensor});
    apply_options(options, scene);
    scene.sample_count = options.spp.value_or(cli::default_test_samples);
    scene.layers = {}; // the picture alone is tested
    check_outputs(options, scene);
    const std::string name = scene.name;
    cli::Progress progress(!options.quiet);
    RenderOptions how = render_options(options, progress, profile);
    how.spp = scene.sample_count;
    activity = "testing " + options.scene;
    cli::Outputs outputs;
    const int exit_code =
        cli::test_command(options.test, std::move(scene), how, [&](const RenderResult &result) {
            progress.finish();
            if (!options.outputs.empty())
                write_pictures(options, name, result, outputs);
        });
    return outputs.report() ? exit_code : cli::exit_output;
}

int resume_command(cli::Options options) {
    const std::string &path = options.checkpoint.resumed;
    activity = "reading " + path;
    const auto checkpoint = std::make_shared<const Checkpoint>(read_checkpoint(path));
    cli::take_run(*checkpoint, path, options);
    if (options.spp && *options.spp < samples_of(*checkpoint))
        throw InputError({path, 0}, fmt::format("has {} samples already, expected -s of as many",
                                                samples_of(*checkpoint)));
    return render_command(options, checkpoint);
}

int self_test_command(const cli::Options &options) {
    activity = "testing the device";
    RenderOptions how;
    how.device = options.device;
    how.lanes = options.lanes;
    how.kernel_dir = options.kernel_dir;
    return selftest::run_self_test(how) ? cli::exit_fine : cli::exit_device;
}

int run(const cli::Options &options) {
    if (options.quiet)
        log::set_level(log::Level::quiet);
    else if (options.verbose)
        log::set_level(log::Level::verbose);
    if (options.max_memory)
        set_memory_limit(*options.max_memory);
    switch (options.command) {
    case cli::Command::list_devices:
        return show_devices();
    case cli::Command::compare:
        return compare_command(options.compare.a, options.compare.b, options.compare.tolerance,
                               options.compare.flip);
    case cli::Command::test:
        return test_command(options);
    case cli::Command::self_test:
        return self_test_command(options);
    case cli::Command::resume:
        return resume_command(options);
    case cli::Command::merge:
        activity = "merging";
        return cli::merge_command(options);
    case cli::Command::render:
        break;
    }
    return render_command(options);
}

/// Tells of the exception that is being handled; returns the exit code.
int explain_exception() {
    try {
        throw;
    } catch (const InputError &e) {
        log::raw(std::string(e.what()) + "\n");
        return cli::exit_input;
    } catch (const OutputError &e) {
        log::error(e.what());
        return cli::exit_output;
    } catch (const DeviceError &e) {
        log::error(e.what());
        return cli::exit_device;
    } catch (const cl::Error &e) {
        log::error(
            fmt::format("OpenCL failed while {}: {} returned {}", activity, e.what(), e.err()));
        return cli::exit_device;
    } catch (const MemoryError &e) {
        log::error(e.what());
        return cli::exit_memory;
    } catch (const std::bad_alloc &) {
        log::error("out of memory while " + activity);
        return cli::exit_memory;
    } catch (const std::length_error &) {
        log::error("more memory than can be addressed is needed while " + activity);
        return cli::exit_memory;
    } catch (const std::exception &e) {
        log::error(
            fmt::format("internal error while {}: {}; please report it", activity, e.what()));
        return cli::exit_internal;
    } catch (...) {
        log::error(fmt::format("internal error while {}; please report it", activity));
        return cli::exit_internal;
    }
}

/// What was printed has to arrive, unless the run has failed anyway.
int finish_stdout(int exit_code) {
    if (exit_code == cli::exit_fine && (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)) {
        log::error("the standard output cannot be written");
        return cli::exit_output;
    }
    return exit_code;
}

} // namespace

int main(int argc, char **argv) {
    cli::ignore_write_signals();
    try {
        const cli::ParseResult parsed = cli::parse_options(argc, argv);
        return finish_stdout(parsed.options ? run(*parsed.options) : parsed.exit_code);
    } catch (...) {
        return explain_exception();
    }
}
