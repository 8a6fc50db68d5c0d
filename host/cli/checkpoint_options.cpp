#include "checkpoint_options.h"

#include "option_values.h"
#include "output_file.h"
#include "stop_options.h"

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
    const std::size_t slash = text.find('/');
    if (slash == std::string::npos)
        return std::nullopt;
    const auto part = parse_number<int>(text.substr(0, slash));
    const auto parts = parse_number<int>(text.substr(slash + 1));
    if (!part || !parts || *part < 1 || *part > *parts || *parts > most_parts)
        return std::nullopt;
    return Part{*part, *parts};
}

/// A subcommand that takes files which others have written, with the options of a render.
CLI::App *add_command(CLI::App &app, const std::string &name, const std::string &description) {
    CLI::App *command = app.add_subcommand(name, description);
    command->footer("");
    command->fallthrough();
    return command;
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
        ->check(parsed_by(parse_duration, "is not a time such as 90s or 5m"))
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
        ->check(parsed_by(parse_part, "is not a part such as 2/3"))
        ->group(group);
}

CLI::App *add_resume(CLI::App &app, CheckpointOptions &options) {
    CLI::App *command =
        add_command(app, "resume",
                    "Goes on with a render from its checkpoint, to the same bits as without a\n"
                    "break; -s, --time and --target-error set another end, -o other pictures");
    command->add_option("FILE", options.resumed, "What --checkpoint has written")
        ->required()
        ->type_name("FILE.exr");
    return command;
}

CLI::App *add_merge(CLI::App &app, CheckpointOptions &options) {
    CLI::App *command =
        add_command(app, "merge",
                    "Adds up the files of --part to the picture of a single render, to the bit;\n"
                    "-o names it, and an .exr file is a checkpoint as well");
    command->add_option("FILES", options.merged, "What --part has written, in any order")
        ->required()
        ->type_name("FILE.exr");
    return command;
}

} // namespace clrender::cli
