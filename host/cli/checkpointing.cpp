#include "cli/checkpointing.h"

#include "checksum.h"
#include "device/kernel_program.h"
#include "device/kernel_sources.h"
#include "error.h"
#include "input_file.h"
#include "log.h"

#include <algorithm>
#include <filesystem>
#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <vector>

namespace clrender::cli {

namespace {

using Json = nlohmann::json;

/// What does not change the picture's bits, or belongs to one part or end of a render alone.
const std::vector<std::string> free_keys = {"scene",        "samples",  "part",          "parts",
                                            "outputs",      "exposure", "folder",        "--aov",
                                            "--kernel-dir", "--time",   "--target-error"};

std::string absolute(const std::string &path) {
    return std::filesystem::absolute(path).lexically_normal().string();
}

/// Of all files that the scene has been read from, and their places beside its own: the folder may
/// be another one, but two files that have changed their names are another scene.
std::string hash_of_scene(const std::string &scene) {
    const std::filesystem::path folder = std::filesystem::path(absolute(scene)).parent_path();
    std::map<std::string, std::uint64_t> sums;
    for (const std::string &path : noted_input_files()) {
        const std::string bytes = read_input_file(path);
        const auto place = std::filesystem::path(absolute(path)).lexically_relative(folder);
        // The scene may have been renamed.
        sums[absolute(path) == absolute(scene) ? "" : place.string()] =
            checksum(0, bytes.data(), bytes.size());
    }
    std::uint64_t sum = 0;
    for (const auto &[place, of_file] : sums) {
        sum = checksum(sum, place.data(), place.size());
        sum = checksum(sum, &of_file, sizeof(of_file));
    }
    return fmt::format("{:016x}", sum);
}

/// Of the kernel's text: another one may compute other bits.
std::string hash_of_kernel(const std::string &folder) {
    std::uint64_t sum = 0;
    for (const KernelSource &source :
         folder.empty() ? embedded_kernel_sources() : read_kernel_sources(folder))
        sum = checksum(sum, source.text.data(), source.text.size());
    return fmt::format("{:016x}", sum);
}

/// What the command line says that changes the picture.
Json picture_options(const Options &options) {
    const auto optional = [](const auto &value) { return value ? Json(*value) : Json(); };
    const SamplingOptions &sampling = options.sampling;
    return {{"version", CLRENDER_VERSION},
            {"-D", options.defines},
            {"--sensor", optional(options.sensor)},
            {"--resolution", options.resolution
                                 ? Json({options.resolution->width, options.resolution->height})
                                 : Json()},
            {"--max-depth", optional(options.max_depth)},
            {"--rr-depth", options.weight_window ? Json("auto") : optional(options.rr_depth)},
            {"--seed", options.seed.value_or(0)},
            {"--precision", options.double_precision ? "double" : "single"},
            {"--accel", sampling.brute_force ? "none" : "bvh"},
            {"--pixel-centers", sampling.pixel_centers},
            {"--sampler", sampling.independent_sampler ? "independent" : "sobol"},
            {"--strategy", static_cast<int>(sampling.strategy)},
            {"--light-samples", sampling.light_samples},
            {"--specular-connections", sampling.specular_connections},
            {"--generic", sampling.forced_features}};
}

template <typename Value> void take(const Json &value, std::optional<Value> &to) {
    to = value.is_null() ? std::nullopt : std::optional<Value>(value.get<Value>());
}

void take_picture_options(const Json &run, Options &options) {
    options.defines = run.at("-D").get<std::map<std::string, std::string>>();
    take(run.at("--sensor"), options.sensor);
    const Json &size = run.at("--resolution");
    options.resolution.reset();
    if (!size.is_null())
        options.resolution = Resolution{size.at(0), size.at(1)};
    take(run.at("--max-depth"), options.max_depth);
    options.weight_window = run.at("--rr-depth") == "auto";
    take(options.weight_window ? Json() : run.at("--rr-depth"), options.rr_depth);
    options.seed = run.at("--seed").get<std::uint32_t>();
    options.double_precision = run.at("--precision") == "double";
    SamplingOptions &sampling = options.sampling;
    sampling.brute_force = run.at("--accel") == "none";
    sampling.pixel_centers = run.at("--pixel-centers");
    sampling.independent_sampler = run.at("--sampler") == "independent";
    sampling.strategy = static_cast<Strategy>(run.at("--strategy").get<int>());
    sampling.light_samples = run.at("--light-samples");
    sampling.specular_connections = run.at("--specular-connections");
    sampling.forced_features = run.at("--generic").get<ForcedFeatures>();
}

/// Where nothing is said of the end, that of the first run; a time is over once it has passed.
void take_end(const Json &run, const std::string &path, Options &options) {
    if (options.spp || options.stop.any())
        return;
    if (run.at("samples") > 0)
        options.spp = run.at("samples").get<int>();
    if (run.at("--target-error") > 0)
        options.stop.error = run.at("--target-error").get<double>();
    if (!options.spp && !options.stop.any())
        throw InputError({path, 0}, "was to end after a time, expected when it is to end now: "
                                    "--time, -s or --target-error");
}

Json parse_run(const std::string &path, const std::string &run) {
    try {
        return Json::parse(run);
    } catch (const Json::exception &) {
        throw InputError({path, 0}, "is a damaged checkpoint (its options)");
    }
}

} // namespace

std::string describe_run(const Options &options) {
    Json run = picture_options(options);
    run["scene"] = absolute(options.scene);
    run["scene files"] = hash_of_scene(options.scene);
    run["kernel"] = hash_of_kernel(options.kernel_dir);
    run["--kernel-dir"] = options.kernel_dir.empty() ? "" : absolute(options.kernel_dir);
    run["samples"] = options.spp.value_or(0);
    run["outputs"] = options.outputs;
    run["exposure"] = options.exposure;
    run["--aov"] = options.layers;
    run["--time"] = options.stop.seconds.value_or(0);
    run["--target-error"] = options.stop.error.value_or(0);
    run["part"] = options.checkpoint.part;
    run["parts"] = options.checkpoint.parts;
    return run.dump();
}

void take_run(const Checkpoint &checkpoint, const std::string &path, Options &options) {
    const Json run = parse_run(path, checkpoint.options);
    const Json said = picture_options(options), nothing_said = picture_options({});
    try {
        for (const auto &[key, value] : said.items()) {
            const bool is_stated = value != nothing_said.at(key);
            if ((is_stated || key == "version") && value != run.at(key))
                throw InputError({path, 0}, fmt::format("was made with {} {}, this run has {}", key,
                                                        run.at(key).dump(), value.dump()));
        }
        if (options.lanes != 0 && options.lanes != checkpoint.layout.lanes)
            throw InputError({path, 0}, fmt::format("was made with --lanes {}, this run has {}",
                                                    checkpoint.layout.lanes, options.lanes));
        take_picture_options(run, options);
        options.scene = run.at("scene");
        options.lanes = checkpoint.layout.lanes;
        if (options.kernel_dir.empty())
            options.kernel_dir = run.at("--kernel-dir");
        take_end(run, path, options);
        if (options.outputs.empty()) {
            options.outputs = run.at("outputs").get<std::vector<std::string>>();
            options.exposure = run.at("exposure");
        }
        if (options.layers.empty())
            options.layers = run.at("--aov").get<std::set<std::string>>();
        options.checkpoint.part = run.at("part");
        options.checkpoint.parts = run.at("parts");
        if (checkpoint.layout.measured)
            options.layers.insert("variance");
        else if (options.stop.error || options.layers.count("variance") != 0)
            throw InputError({path, 0}, "has no variances, expected one that was begun with "
                                        "--target-error or --aov variance");
    } catch (const Json::exception &) {
        throw InputError({path, 0}, "is a damaged checkpoint (its options)");
    }
}

void check_same_run(const std::string &a_path, const std::string &a_run, const std::string &b_path,
                    const std::string &b_run) {
    const Json a = parse_run(a_path, a_run), b = parse_run(b_path, b_run);
    for (const auto &[key, value] : a.items()) {
        if (std::find(free_keys.begin(), free_keys.end(), key) != free_keys.end())
            continue;
        const Json other = b.contains(key) ? b.at(key) : Json();
        if (value == other)
            continue;
        if (key == "scene files")
            throw InputError({a_path, 0},
                             "is of another scene than " + b_path + " (a file of it has changed)");
        if (key == "kernel")
            throw InputError({a_path, 0}, "was made by another kernel than " + b_path);
        throw InputError({a_path, 0}, fmt::format("was made with {} {}, {} with {}", key,
                                                  value.dump(), b_path, other.dump()));
    }
}

PartOfRun part_of_run(const std::string &run) {
    const Json json = parse_run("the checkpoint", run);
    return {json.value("part", 1), json.value("parts", 1), json.value("samples", 0)};
}

std::string with_part(const std::string &run, int part, int parts) {
    Json json = Json::parse(run);
    json["part"] = part;
    json["parts"] = parts;
    return json.dump();
}

bool CheckpointWriter::is_due() const {
    constexpr double least_interval = 60, least_ratio = 100;
    const double interval =
        options_.interval.value_or(std::max(least_interval, least_ratio * cost_));
    return std::chrono::duration<double>(Clock::now() - last_).count() >= interval;
}

void CheckpointWriter::write(Checkpoint checkpoint, const Image &picture,
                             const std::map<std::string, std::string> &metadata) {
    const Clock::time_point start = Clock::now();
    checkpoint.options = run_;
    failure_.clear();
    try {
        write_checkpoint(options_.file, checkpoint, picture, metadata);
    } catch (const std::bad_alloc &) {
        failure_ = options_.file + ": cannot be written (out of memory)";
    } catch (const OutputError &error) {
        failure_ = error.what();
    }
    if (!failure_.empty())
        log::warn(failure_ + "; the checkpoint before it stays, and the render goes on");
    last_ = Clock::now();
    cost_ = std::chrono::duration<double>(last_ - start).count();
}

void CheckpointWriter::check() const {
    if (!failure_.empty())
        throw std::runtime_error(failure_);
}

} // namespace clrender::cli
