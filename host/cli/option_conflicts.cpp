#include "cli/option_conflicts.h"

#include <filesystem>
#include <fmt/core.h>
#include <set>

namespace clrender::cli {

std::optional<std::string> conflict_of_merge(const CLI::App &app) {
    const std::set<std::string> taken = {"--output", "--exposure", "--max-memory", "--quiet",
                                         "--verbose"};
    for (const CLI::Option *option : app.get_options())
        if (option->count() > 0 && taken.count(option->get_name()) == 0)
            return fmt::format("merge takes no {}: its files know how they were rendered",
                               option->get_name());
    return std::nullopt;
}

std::optional<std::string> conflict_of_ends(const Options &options, bool with_profile) {
    const CheckpointOptions &checkpoint = options.checkpoint;
    const bool has_checkpoint = !checkpoint.file.empty() || checkpoint.parts > 1;
    if (options.command == Command::resume || options.command == Command::merge) {
        if (!options.scene.empty())
            return "resume and merge know their scene, expected no SCENE";
        if (checkpoint.parts > 1 || options.check)
            return "resume and merge exclude --part and --check";
    }
    if (options.command == Command::merge && options.outputs.empty())
        return "merge needs -o, the picture to write";
    std::error_code ignored;
    if (options.command == Command::render && std::filesystem::exists(checkpoint.file, ignored))
        return fmt::format("'{0}' is there already: `clrender resume {0}` goes on from it, or "
                           "remove it",
                           checkpoint.file);
    if (options.command == Command::test && has_checkpoint)
        return "test excludes --checkpoint and --part";
    if (has_checkpoint && with_profile)
        return "--profile excludes --checkpoint and --part: it shows every sample once";
    if (checkpoint.parts > 1 && options.stop.any())
        return "--part takes a number of samples, it excludes --time and --target-error";
    if (options.command == Command::test && options.stop.any())
        return "test decides itself when it is done, it excludes --time and --target-error";
    if (options.stop.any() && with_profile)
        return "--profile excludes --time and --target-error: it shows every sample once";
    return std::nullopt;
}

std::optional<std::string> conflict_of_files(const std::vector<std::string> &files) {
    std::set<std::string> seen;
    for (const std::string &file : files)
        if (!seen.insert(std::filesystem::path(file).lexically_normal().string()).second)
            return fmt::format("'{}' is to be written twice", file);
    return std::nullopt;
}

} // namespace clrender::cli
