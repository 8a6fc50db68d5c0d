#include "cli/options.h"

#include "cli/option_conflicts.h"
#include "cli/option_values.h"
#include "image/image.h"
#include "log.h"
#include "output_file.h"
#include "scene/limits.h"
#include "verify/picture_test.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <fmt/core.h>
#include <limits>
#include <optional>

namespace clrender::cli {

namespace fs = std::filesystem;

namespace {

constexpr int max_int = std::numeric_limits<int>::max();

constexpr int least_test_samples = verify::first_batch * verify::least_batches;

constexpr const char *examples =
    "Examples:\n"
    "  clrender scene.xml                       writes scene.png and scene.exr\n"
    "  clrender model.obj -o model.png          a bare model: the camera frames it\n"
    "  clrender scene.xml -r 320x180 -s 16      a quick look\n"
    "  clrender scene.xml -D light_radius=10    sets a <default> of the scene\n"
    "  clrender compare a.exr b.exr --tolerance 1e-3\n"
    "  clrender test scene.xml --reference right.exr\n"
    "\n"
    "Exit codes: 0 fine, 1 the pictures differ (compare, test), 2 wrong input, 3 no usable device\n"
    "(or one that fails --self-test), 4 a file could not be written (all others are), 5 out of\n"
    "memory, 70 a fault of clrender itself, 130 and 143 interrupted by SIGINT and SIGTERM (the\n"
    "picture so far is written).\n";

/// The layers that --aov knows.
const std::vector<std::string> &known_layers() {
    static const std::vector<std::string> names = {
        "variance",   "samples", "albedo", "normal",      "depth",      "position",   "uv",
        "geo_normal", "dp_du",   "dp_dv",  "shape_index", "prim_index", "cryptomatte"};
    return names;
}

std::string check_layer(const std::string &text) {
    const auto &known = known_layers();
    if (std::find(known.begin(), known.end(), text) != known.end())
        return {};
    return fmt::format("'{}' is no layer, expected {}", text, CLI::detail::join(known, ", "));
}

std::optional<Resolution> parse_resolution(const std::string &text) {
    const std::size_t cross = text.find('x');
    if (cross == std::string::npos)
        return std::nullopt;
    const auto width = parse_number<int>(text.substr(0, cross));
    const auto height = parse_number<int>(text.substr(cross + 1));
    if (!width || !height)
        return std::nullopt;
    return Resolution{*width, *height};
}

std::string check_resolution(const std::string &text) {
    const auto size = parse_resolution(text);
    if (!size)
        return fmt::format("'{}' is not WIDTHxHEIGHT, such as 640x480", text);
    const auto is_side = [](int side) { return side >= 1 && side <= max_picture_side; };
    if (!is_side(size->width) || !is_side(size->height))
        return fmt::format("'{}' is not within 1x1 and {}x{}", text, max_picture_side,
                           max_picture_side);
    if (std::int64_t{size->width} * size->height > max_picture_pixels)
        return fmt::format("'{}' has more than {} pixels", text, max_picture_pixels);
    return {};
}

/// `name=value`; the name as a scene can write it after `$`.
std::string check_define(const std::string &text) {
    const std::size_t equals = text.find('=');
    const auto is_name_char = [](unsigned char c) {
        return std::isalnum(c) != 0 || std::strchr("_-.", c) != nullptr;
    };
    const std::string name = text.substr(0, equals);
    if (equals == std::string::npos || name.empty() ||
        !std::all_of(name.begin(), name.end(), is_name_char))
        return fmt::format("'{}' is not name=value (a name of letters, digits, _ - .)", text);
    return {};
}

std::string check_folder(const std::string &path) {
    std::error_code ignored;
    return fs::is_directory(path, ignored) ? "" : fmt::format("there is no folder '{}'", path);
}

/// What `--profile` without a file becomes.
constexpr const char *bare_profile = "true";

bool is_json_path(const std::string &text) {
    return fs::path(text).extension() == ".json";
}

std::string check_profile(const std::string &text) {
    if (text == bare_profile)
        return {};
    return is_json_path(text) ? why_not_writable(text)
                              : fmt::format("'{}' does not end in .json", text);
}

/// The arguments in the reverse order that CLI11 wants. `--profile FILE.json` becomes
/// `--profile=FILE.json`: anything else that follows --profile is not its value.
std::vector<std::string> reversed_arguments(int argc, const char *const *argv) {
    std::vector<std::string> arguments;
    bool options_end = false;
    for (int i = 1; i < argc; ++i) {
        std::string argument = argv[i];
        const std::string next = i + 1 < argc ? argv[i + 1] : "";
        options_end = options_end || argument == "--";
        if (!options_end && argument == "--profile" && next[0] != '-' && is_json_path(next)) {
            argument += "=" + next;
            ++i;
        }
        arguments.push_back(std::move(argument));
    }
    std::reverse(arguments.begin(), arguments.end());
    return arguments;
}

std::string check_output(const std::string &path) {
    if (!path.empty() && !is_writable_image_path(path))
        return fmt::format("'{}' does not end in .png, .jpg, .hdr, .exr or .pfm", path);
    return why_not_writable(path);
}

std::string check_feature(const std::string &name) {
    const ForcedFeatures &known = all_features();
    if (name == "all" || known.count(name) != 0)
        return {};
    const std::vector<std::string> names(known.begin(), known.end());
    return fmt::format("'{}' is not all or of {}", name, CLI::detail::join(names, " "));
}

/// What CLI11 fills as text, because it has to be taken apart afterwards.
struct RawOptions {
    std::string resolution;
    std::string lanes = "auto";
    std::string precision = "single";
    std::string accel = "bvh";
    std::string sampler = "sobol";
    std::string light_samples = "auto";
    std::string rr_depth;
    std::string strategy = "mis";
    std::string specular_connections = "auto";
    std::string profile;
    std::string max_memory;
    std::string effect = "1%";
    std::vector<std::string> generic;
    std::vector<std::string> layers;
    std::vector<std::string> defines;
    bool list_devices = false;
    bool self_test = false;
};

void add_picture_options(CLI::App &app, Options &options, RawOptions &raw) {
    app.add_option("SCENE", options.scene,
                   "Mitsuba 3 scene (.xml) or a model (.gltf, .glb, .obj, .ply)")
        ->type_name("");
    app.add_option("-o,--output", options.outputs,
                   "Picture to write, repeatable: .png .jpg .hdr .exr .pfm\n"
                   "(default: SCENE's name, .png and .exr, in the current folder)")
        ->type_name("FILE")
        ->allow_extra_args(false)
        ->check(CLI::Validator(check_output, ""))
        ->group("Pictures");
    app.add_option("-r,--resolution", raw.resolution, "Size of the picture in pixels")
        ->type_name("WxH")
        ->check(CLI::Validator(check_resolution, ""))
        ->group("Pictures");
    app.add_option("--exposure", options.exposure, "Stops brighter, in .png and .jpg only")
        ->type_name("EV")
        ->check(number(-100, 100))
        ->group("Pictures");
    app.add_option("--aov", raw.layers,
                   "Layers of .exr files beside the picture, comma-separated: " +
                       CLI::detail::join(known_layers(), ", "))
        ->type_name("LAYER")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::Validator(check_layer, ""))
        ->group("Pictures");
    app.add_option("--sensor", options.sensor, "Which of the scene's cameras, the first being 0")
        ->type_name("N")
        ->check(whole_number(0, max_int))
        ->group("Pictures");
    app.add_option("-D", raw.defines, "Sets a <default> of the scene, repeatable")
        ->type_name("name=value")
        ->allow_extra_args(false)
        ->check(CLI::Validator(check_define, ""))
        ->group("Pictures");
}

void add_sampling_options(CLI::App &app, Options &options, RawOptions &raw) {
    const char *group = "Sampling (default: as the scene says)";
    app.add_option("-s,--spp", options.spp, "Samples a pixel")
        ->type_name("N")
        ->check(whole_number(1, max_sample_count))
        ->group(group);
    app.add_option("--max-depth", options.max_depth, "Longest path in segments, -1: no limit")
        ->type_name("N")
        ->check(whole_number(-1, max_int))
        ->group(group);
    app.add_option("--rr-depth", raw.rr_depth,
                   "Depth from which roulette ends paths, or auto: by what they carry, from the\n"
                   "second diffuse surface on, which is the default where the scene states none")
        ->type_name("N")
        ->check(auto_or(whole_number(1, max_int)))
        ->group(group);
    app.add_option("--seed", options.seed, "Another seed, other noise")
        ->type_name("N")
        ->check(whole_number(0, std::numeric_limits<std::uint32_t>::max()))
        ->group(group);
    app.add_flag("--pixel-centers", options.sampling.pixel_centers,
                 "All samples at the centres of the pixels, no filter")
        ->group(group);
    app.add_option("--sampler", raw.sampler,
                   "sobol, or independent: random numbers without order (default: sobol)")
        ->type_name("NAME")
        ->check(one_of({"sobol", "independent"}))
        ->group(group);
    app.add_option("--light-samples", raw.light_samples,
                   "Lights sampled where a path first meets a diffuse surface:\n"
                   "auto, 1, 2, 4, 8, 16 (default: auto)")
        ->type_name("N")
        ->check(one_of({"auto", "1", "2", "4", "8", "16"}))
        ->group(group);
    app.add_option("--strategy", raw.strategy,
                   "How light is looked for: mis, by light and BSDF sampling, or by light or bsdf\n"
                   "sampling alone (default: mis)")
        ->type_name("NAME")
        ->check(one_of({"mis", "light", "bsdf"}))
        ->group(group);
    app.add_option("--specular-connections", raw.specular_connections,
                   "Light sampling over mirrors and through balls of glass: auto, where a scene\n"
                   "has them, or off (default: auto)")
        ->type_name("WHEN")
        ->check(one_of({"auto", "off"}))
        ->group(group);
    app.add_option("--accel", raw.accel, "bvh, or none: test every triangle (default: bvh)")
        ->type_name("WHICH")
        ->check(one_of({"bvh", "none"}))
        ->group(group);
}

void add_run_options(CLI::App &app, Options &options, RawOptions &raw) {
    const char *group = "Device and run";
    app.add_option("-d,--device", options.device,
                   "auto, cpu, gpu, an INDEX of the list, or part of a name (default: auto)")
        ->type_name("SPEC")
        ->check(not_empty())
        ->group(group);
    app.add_flag("--list-devices", raw.list_devices, "Lists the devices and ends")->group(group);
    app.add_flag("--self-test", raw.self_test,
                 "Compares what the device computes with double precision and closed\n"
                 "forms, and ends: prints a table; exit code 3 if anything is wrong")
        ->group(group);
    app.add_option("--lanes", raw.lanes, "Paths side by side: auto, 1, 4, 8, 16 (default: auto)")
        ->type_name("N")
        ->check(one_of({"auto", "1", "4", "8", "16"}))
        ->group(group);
    app.add_option("--precision", raw.precision,
                   "single, or double: slow, to tell what rounding does (default: single)")
        ->type_name("NAME")
        ->check(one_of({"single", "double"}))
        ->group(group);
    app.add_option("--max-memory", raw.max_memory,
                   "Refuses scenes that need more, on host and device together, such as 4G\n"
                   "(default: what the machine has)")
        ->type_name("SIZE")
        ->check(parsed_by(parse_size, "is not a size such as 512M or 4G"))
        ->group(group);
    app.add_option("--kernel-dir", options.kernel_dir,
                   "Kernel sources instead of the built-in ones")
        ->type_name("FOLDER")
        ->check(CLI::Validator(check_folder, ""))
        ->group(group);
    app.add_option("--generic", raw.generic,
                   "Compiles the kernel for these features too, comma-separated, or all")
        ->type_name("NAME")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::Validator(check_feature, ""))
        ->group(group);
    app.add_option("--stats", options.stats, "Writes the figures of the run as JSON")
        ->type_name("FILE.json")
        ->check(CLI::Validator(why_not_writable, ""))
        ->group(group);
    app.add_flag("--profile", raw.profile,
                 "Prints where the device's time goes; with FILE.json after it,\n"
                 "writes a trace for Perfetto as well")
        ->check(CLI::Validator(check_profile, ""))
        ->group(group);
    app.add_flag("--check", options.check, "Reads and checks the scene, renders nothing")
        ->group(group);
    app.add_flag("-q,--quiet", options.quiet, "Warnings and errors only")->group(group);
    app.add_flag("-v,--verbose", options.verbose, "Tells what is done and how long it takes")
        ->group(group);
    app.set_version_flag("--version", "clrender " CLRENDER_VERSION, "Prints the version")
        ->group(group);
    app.set_help_flag("-h,--help", "Prints this help")->group(group);

    // For the tests that a picture does not depend on how it is cut into launches; not in --help.
    app.add_option("--batch", options.batch)->check(whole_number(1, max_int))->group("");
    app.add_option("--tile", options.tile)->check(whole_number(1, max_int))->group("");
    app.add_option("--band-rows", options.band_rows)->check(whole_number(1, max_int))->group("");
    app.add_flag("--preview", options.preview)->group("");
}

std::string check_png(const std::string &path) {
    if (fs::path(path).extension() != ".png")
        return fmt::format("'{}' does not end in .png", path);
    return why_not_writable(path);
}

CLI::App *add_compare(CLI::App &app, CompareOptions &compare) {
    CLI::App *command = app.add_subcommand(
        "compare", "Prints how far picture A is from picture B: mean squared error, relMSE,\n"
                   "bias, largest difference; exit code 1 beyond the tolerance");
    command->footer("");
    command->add_option("A", compare.a, "A picture")->required()->type_name("");
    command->add_option("B", compare.b, "The reference")->required()->type_name("");
    command
        ->add_option("--tolerance", compare.tolerance,
                     "The largest relMSE that counts as equal (default: 0)")
        ->type_name("X")
        ->check(number(0, 1e9));
    command
        ->add_option("--flip", compare.flip,
                     "Writes where the eye sees a difference (FLIP), and prints its mean")
        ->type_name("FILE.png")
        ->check(CLI::Validator(check_png, ""));
    return command;
}

/// A share above 0 and at most 1, or with % behind it of 100.
std::optional<double> parse_effect(const std::string &text) {
    const bool percent = text.ends_with('%');
    const auto value = parse_number<double>(text.substr(0, text.size() - (percent ? 1 : 0)));
    const double share = value.value_or(0) / (percent ? 100 : 1);
    return share > 0 && share <= 1 ? std::optional(share) : std::nullopt;
}

std::string check_effect(const std::string &text) {
    return parse_effect(text) ? "" : fmt::format("'{}' is not a share such as 1% or 0.01", text);
}

CLI::App *add_test(CLI::App &app, Options &options, RawOptions &raw) {
    CLI::App *command = app.add_subcommand(
        "test", "Renders SCENE, with the options of a render, until it differs from a reference\n"
                "by more than the noise of both (exit code 1) or an effect is excluded (0), at\n"
                "most -s samples a pixel (default: 65536)");
    command->footer("");
    command->fallthrough();
    command->add_option("SCENE", options.scene, "As for a render")->required()->type_name("");
    command
        ->add_option("--reference", options.test.reference,
                     "The picture as it should be, best written with --aov variance,samples")
        ->required()
        ->type_name("REF.exr");
    command
        ->add_option("--effect", raw.effect,
                     "The change of the picture's mean to be excluded; of 8x8 pixels ten times\n"
                     "as much, of 4x4 five times (default: 1%)")
        ->type_name("X")
        ->check(CLI::Validator(check_effect, ""));
    command
        ->add_option("--marked", options.test.marked,
                     "Shows where the pictures differ, if they do (default: the reference's\n"
                     "name with _differs.png, in the current folder)")
        ->type_name("FILE.png")
        ->check(CLI::Validator(check_png, ""));
    return command;
}

void finish_sampling(SamplingOptions &sampling, const RawOptions &raw) {
    sampling.light_samples =
        raw.light_samples == "auto" ? 0 : *parse_number<int>(raw.light_samples);
    sampling.strategy = raw.strategy == "light"  ? Strategy::light
                        : raw.strategy == "bsdf" ? Strategy::bsdf
                                                 : Strategy::mis;
    sampling.independent_sampler = raw.sampler == "independent";
    sampling.brute_force = raw.accel == "none";
    sampling.specular_connections = raw.specular_connections == "auto";
    for (const std::string &name : raw.generic) {
        if (name == "all")
            sampling.forced_features = all_features();
        else
            sampling.forced_features.insert(name);
    }
}

/// Takes the texts apart that CLI11 has checked, and fills in the default outputs.
void finish_options(Options &options, const RawOptions &raw) {
    if (!raw.resolution.empty())
        options.resolution = parse_resolution(raw.resolution);
    options.lanes = raw.lanes == "auto" ? 0 : *parse_number<int>(raw.lanes);
    options.weight_window = raw.rr_depth == "auto";
    if (!raw.rr_depth.empty() && !options.weight_window)
        options.rr_depth = parse_number<int>(raw.rr_depth);
    finish_sampling(options.sampling, raw);
    options.double_precision = raw.precision == "double";
    if (!raw.max_memory.empty())
        options.max_memory = parse_size(raw.max_memory);
    options.profile = !raw.profile.empty();
    if (raw.profile != bare_profile)
        options.profile_trace = raw.profile;
    options.test.effect = *parse_effect(raw.effect);
    if (options.command == Command::test && options.test.marked.empty())
        options.test.marked = fs::path(options.test.reference).stem().string() + "_differs.png";
    options.layers.insert(raw.layers.begin(), raw.layers.end());
    for (const std::string &define : raw.defines) {
        const std::size_t equals = define.find('=');
        options.defines[define.substr(0, equals)] = define.substr(equals + 1);
    }
    const std::string stem = fs::path(options.scene).stem().string();
    CheckpointOptions &checkpoint = options.checkpoint;
    if (options.command == Command::resume && checkpoint.file.empty())
        checkpoint.file = checkpoint.resumed;
    if (checkpoint.parts > 1) {
        if (checkpoint.file.empty())
            checkpoint.file =
                fmt::format("{}.part{}of{}.exr", stem, checkpoint.part, checkpoint.parts);
    } else if (options.outputs.empty() && options.command == Command::render) {
        options.outputs = {stem + ".png", stem + ".exr"};
    }
}

/// What the options may not say together. Throws CLI::ParseError.
void check_combination(const Options &options, const RawOptions &raw) {
    const auto refuse = [](const std::string &text) {
        throw CLI::ParseError(text, CLI::ExitCodes::ValidationError);
    };
    if (options.command == Command::render && options.scene.empty())
        refuse("SCENE is missing");
    if (options.command == Command::compare && !options.scene.empty())
        refuse("compare takes two pictures and no SCENE");
    if (options.command == Command::self_test && !options.scene.empty())
        refuse("--self-test takes no SCENE");
    if (options.command == Command::test &&
        (options.check || !options.stats.empty() || !raw.profile.empty()))
        refuse("test excludes --check, --stats and --profile");
    if (options.command == Command::test && options.spp && *options.spp < least_test_samples)
        refuse(fmt::format("test takes at least {} samples, -s allows {}", least_test_samples,
                           *options.spp));
    if (const auto conflict = conflict_of_ends(options, !raw.profile.empty()))
        refuse(*conflict);
    if (options.quiet && options.verbose)
        refuse("--quiet excludes --verbose");
    if (raw.precision == "double" && raw.lanes != "auto" && raw.lanes != "1")
        refuse("--precision double traces one path at a time, it excludes --lanes " + raw.lanes);
    std::vector<std::string> files = options.outputs;
    const CheckpointOptions &checkpoint = options.checkpoint;
    for (const std::string &file : {options.stats, raw.profile,
                                    checkpoint.file.empty() ? checkpoint.resumed : checkpoint.file})
        if (!file.empty() && file != bare_profile)
            files.push_back(file);
    if (const auto conflict = conflict_of_files(files))
        refuse(*conflict);
}

/// One line, whatever CLI11 wrote.
void print_mistake(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    log::error(text + " (clrender --help lists the options)");
}

} // namespace

ParseResult parse_options(int argc, const char *const *argv) {
    Options options;
    RawOptions raw;
    CLI::App app("clrender: a physically based path tracer on OpenCL\n", "clrender");
    app.get_formatter()->column_width(28);
    app.set_help_flag(); // added again as the last option, so that --help starts with the pictures
    app.footer(examples);
    add_picture_options(app, options, raw);
    add_sampling_options(app, options, raw);
    add_stop_options(app, options.stop);
    add_checkpoint_options(app, options.checkpoint);
    add_run_options(app, options, raw);
    const CLI::App *compare = add_compare(app, options.compare);
    const CLI::App *test = add_test(app, options, raw);
    const CLI::App *resume = add_resume(app, options.checkpoint);
    const CLI::App *merge = add_merge(app, options.checkpoint);

    try {
        app.parse(reversed_arguments(argc, argv));
        options.command = raw.list_devices    ? Command::list_devices
                          : raw.self_test     ? Command::self_test
                          : compare->parsed() ? Command::compare
                          : test->parsed()    ? Command::test
                          : resume->parsed()  ? Command::resume
                          : merge->parsed()   ? Command::merge
                                              : Command::render;
        check_combination(options, raw);
        if (options.command == Command::merge)
            if (const auto conflict = conflict_of_merge(app))
                throw CLI::ParseError(*conflict, CLI::ExitCodes::ValidationError);
    } catch (const CLI::Success &help_or_version) {
        return {std::nullopt, app.exit(help_or_version)};
    } catch (const CLI::ParseError &mistake) {
        print_mistake(mistake.what());
        return {std::nullopt, 2};
    }
    finish_options(options, raw);
    return {options, 0};
}

} // namespace clrender::cli
