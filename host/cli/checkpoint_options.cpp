#include "checkpoint_options.h"

#include "output_file.h"
#include "stop_options.h"

#include <charconv>
#include <filesystem>
#include <fmt/core.h>

namespace clrender::cli {

namespace {

constexpr const char *group = "Checkpoints and parts";

std::string check_exr(const std::string &path) {
    if (std::filesystem::path(path).extension() != ".exr")
        return fmt::format("'{}' does not end in .exr", path);
    return why_not_writable(path);
}

struct Part {
    int part = 0, parts = 0;
};

/// "2/3".
std::optional<Part> parse_part(const std::string &text) {
    constexpr int most_parts = 1 << 20;
    Part part;
    const char *end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, part.part);
    if (first.ec != std::errc() || first.ptr == end || *first.ptr != '/')
        return std::nullopt;
    const auto second = std::from_chars(first.ptr + 1, end, part.parts);
    if (second.ec != std::errc() || second.ptr != end || part.part < 1 || part.part > part.parts ||
        part.parts > most_parts)
        return std::nullopt;
    return part;
}

} // namespace

void add_checkpoint_options(CLI::App &app, CheckpointOptions &options) {
    app.add_option("--checkpoint", options.file,
                   "Writes now and then, and at the end, a picture from which\n"
                   "`clrender resume` goes on")
        ->type_name("FILE.exr")
        ->check(CLI::Validator(check_exr, ""))
        ->group(group);
    app.add_option_function<std::string>(
           "--checkpoint-interval",
           [&](const std::string &text) { options.interval = parse_duration(text); },
           "Between two checkpoints (default: a minute, or 100 times what one takes)")
        ->type_name("T")
        ->check(CLI::Validator(
            [](const std::string &text) {
                return parse_duration(text)
                           ? std::string()
                           : fmt::format("'{}' is not a time such as 90s or 5m", text);
            },
            ""))
        ->group(group);
    app.add_option_function<std::string>(
           "--part",
           [&](const std::string &text) {
               const auto part = parse_part(text);
               options.part = part->part;
               options.parts = part->parts;
           },
           "Renders the Kth of N shares of the samples, for `clrender merge`\n"
           "(into --checkpoint; default: SCENE's name with .partKofN.exr)")
        ->type_name("K/N")
        ->check(CLI::Validator(
            [](const std::string &text) {
                return parse_part(text) ? std::string()
                                        : fmt::format("'{}' is not a part such as 2/3", text);
            },
            ""))
        ->group(group);
}

CLI::App *add_resume(CLI::App &app, CheckpointOptions &options) {
    CLI::App *command = app.add_subcommand(
        "resume", "Goes on with a render from its checkpoint, to the same bits as without a\n"
                  "break; -s, --time and --target-error set another end, -o other pictures");
    command->footer("");
    command->fallthrough();
    command->add_option("FILE", options.resumed, "What --checkpoint has written")
        ->required()
        ->type_name("FILE.exr");
    return command;
}

CLI::App *add_merge(CLI::App &app, CheckpointOptions &options) {
    CLI::App *command = app.add_subcommand(
        "merge", "Adds up the files of --part to the picture of a single render, to the bit;\n"
                 "-o names it, and an .exr file is a checkpoint as well");
    command->footer("");
    command->fallthrough();
    command->add_option("FILES", options.merged, "What --part has written, in any order")
        ->required()
        ->type_name("FILE.exr");
    return command;
}

} // namespace clrender::cli
