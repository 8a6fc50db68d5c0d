#pragma once
/// What the command line says of checkpoints, parts and their merging.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace clrender::cli {

struct CheckpointOptions {
    std::string file;                ///< --checkpoint, or empty
    std::optional<double> interval;  ///< --checkpoint-interval, seconds
    int part = 1, parts = 1;         ///< --part
    std::string resumed;             ///< of `clrender resume`
    std::vector<std::string> merged; ///< of `clrender merge`
};

/// Adds the options to those of a render.
void add_checkpoint_options(CLI::App &app, CheckpointOptions &options);

/// The commands; each takes the options of a render as well.
CLI::App *add_resume(CLI::App &app, CheckpointOptions &options);
CLI::App *add_merge(CLI::App &app, CheckpointOptions &options);

} // namespace clrender::cli
