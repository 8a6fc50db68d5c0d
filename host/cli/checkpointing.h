#pragma once
/// Checkpoints as a run writes them, and runs that go on from them.

#include "cli/options.h"
#include "film/checkpoint.h"

#include <chrono>
#include <functional>
#include <map>
#include <string>

namespace clrender::cli {

/// What a checkpoint knows of the run that writes it, as JSON; to be asked when the scene has been
/// read: the hash of all files that it consists of is part of it.
std::string describe_run(const Options &options);

/// Puts what `options` leave open in the place where the run of a checkpoint had it: the scene, its
/// options and pictures. Throws InputError where they say something else that would change the
/// bits.
void take_run(const Checkpoint &checkpoint, const std::string &path, Options &options);

/// Throws InputError, naming what differs, unless both runs render the same picture.
void check_same_run(const std::string &a_path, const std::string &a_run, const std::string &b_path,
                    const std::string &b_run);

/// The part of `parts` that a run renders, and its number of samples.
struct PartOfRun {
    int part = 1, parts = 1, samples = 0;
};
PartOfRun part_of_run(const std::string &run);
/// The same run with another part.
std::string with_part(const std::string &run, int part, int parts);

/// Writes the checkpoints of a render. One that cannot be written costs a warning.
class CheckpointWriter {
public:
    CheckpointWriter(const CheckpointOptions &options, std::string run)
        : options_(options), run_(std::move(run)) {}

    [[nodiscard]] bool is_due() const;
    void write(Checkpoint checkpoint, const Image &picture,
               const std::map<std::string, std::string> &metadata);
    /// Throws OutputError if the last one could not be written.
    void check() const;

private:
    using Clock = std::chrono::steady_clock;

    CheckpointOptions options_;
    std::string run_;
    std::string failure_;
    Clock::time_point last_ = Clock::now();
    double cost_ = 0; ///< seconds of the last one
};

/// `clrender merge`; returns the exit code.
int merge_command(const Options &options);

} // namespace clrender::cli
