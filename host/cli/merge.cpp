#include "cli/checkpointing.h"
#include "cli/exit_codes.h"
#include "cli/outputs.h"
#include "error.h"
#include "film/film_blocks.h"
#include "log.h"

#include <filesystem>
#include <fmt/core.h>
#include <set>

namespace clrender::cli {

namespace {

/// Adds the files up, each read once.
Checkpoint merged(const std::vector<std::string> &files, std::set<int> &parts) {
    Checkpoint sum = read_checkpoint(files.front());
    const std::string run = sum.options;
    parts.insert(part_of_run(run).part);
    for (std::size_t i = 1; i < files.size(); ++i) {
        const Checkpoint part = read_checkpoint(files[i]);
        check_same_run(files[i], part.options, files.front(), run);
        const PartOfRun a = part_of_run(part.options), b = part_of_run(run);
        if (a.parts != b.parts || a.samples != b.samples)
            throw InputError({files[i], 0},
                             fmt::format("is one of {} parts of {} samples, {} of {} parts of {}",
                                         a.parts, a.samples, files.front(), b.parts, b.samples));
        if (!(part.layout == sum.layout))
            throw InputError({files[i], 0},
                             fmt::format("was made with other --lanes ({}), variances or kind of "
                                         "device than {} ({})",
                                         part.layout.lanes, files.front(), sum.layout.lanes));
        if (overlap(sum.work, part.work))
            throw InputError(
                {files[i], 0},
                fmt::format("has samples that another file has (part {} of {})", a.part, a.parts));
        parts.insert(a.part);
        add_checkpoint(sum, part);
    }
    return sum;
}

void warn_of_missing(const Checkpoint &sum, const std::set<int> &parts, const PartOfRun &of) {
    const int blocks = blocks_of(of.samples);
    std::string missing;
    for (int part = 1; part <= of.parts; ++part) {
        const Work wanted = part_of_work(sum.layout.grid, blocks, part, of.parts);
        if (missing_work(wanted, sum.work).empty())
            continue;
        missing += fmt::format("{}{}{}", missing.empty() ? "" : ", ", part,
                               parts.count(part) != 0 ? " (not complete)" : "");
    }
    if (!missing.empty())
        log::warn(fmt::format("of {} parts, these are missing: {}", of.parts, missing));
}

} // namespace

int merge_command(const Options &options) {
    std::set<int> parts;
    Checkpoint sum = merged(options.checkpoint.merged, parts);
    const PartOfRun of = part_of_run(sum.options);
    if (of.parts > 1)
        warn_of_missing(sum, parts, of);
    sum.options = with_part(sum.options, 1, 1);

    const Image picture = film_mean(sum.film, sum.layout.format);
    const int samples = samples_of(sum);
    const std::map<std::string, std::string> about = {{"samples", std::to_string(samples)},
                                                      {"version", CLRENDER_VERSION}};
    Outputs outputs;
    for (const std::string &path : options.outputs)
        outputs.attempt(path, [&] {
            if (std::filesystem::path(path).extension() == ".exr")
                write_checkpoint(path, sum, picture, about);
            else
                write_image(path, picture, options.exposure, about);
        });
    log::info(fmt::format("merged {} files: {}x{}, {} samples a pixel",
                          options.checkpoint.merged.size(), picture.width, picture.height,
                          samples));
    return outputs.report() ? exit_fine : exit_output;
}

} // namespace clrender::cli
