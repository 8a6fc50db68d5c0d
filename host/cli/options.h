#pragma once
/// The command line: what it may say, checked completely, before anything else runs.

#include "cli/checkpoint_options.h"
#include "cli/stop_options.h"
#include "config/sampling_options.h"

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace clrender::cli {

enum class Command { render, compare, test, list_devices, self_test, resume, merge };

struct Resolution {
    int width = 0;
    int height = 0;
};

/// `clrender compare A B`.
struct CompareOptions {
    std::string a;
    std::string b;
    double tolerance = 0; ///< the largest relMSE that counts as equal
    std::string flip;     ///< PNG file for the FLIP map, or empty
};

/// `clrender test SCENE`, beside the options of a render.
struct TestOptions {
    std::string reference;
    std::string marked;   ///< PNG, or empty: the reference's name with _differs.png
    double effect = 0.01; ///< the relative difference of the mean that is to be excluded
};

/// A valid command line. What is not set is left to the scene file or to the program.
struct Options {
    Command command = Command::render;
    std::string scene;
    std::vector<std::string>
        outputs;                 ///< never empty for Command::render: the defaults are filled in
    std::string device = "auto"; ///< auto, cpu, gpu, an index or a part of a name
    std::optional<int> spp;
    std::optional<Resolution> resolution;
    std::optional<int> max_depth; ///< -1: no limit, as in a scene file
    std::optional<int> rr_depth;
    bool weight_window = false; ///< roulette is one, even where the scene states an rr_depth
    std::optional<std::uint32_t> seed;
    int lanes = 0;             ///< 1, 4, 8 or 16; 0: as wide as the device
    std::optional<int> sensor; ///< of the scene's sensors, counted from 0
    std::map<std::string, std::string> defines;
    double exposure = 0;          ///< stops, for the 8-bit formats
    std::set<std::string> layers; ///< --aov: of the EXR files, beside the picture
    SamplingOptions sampling;
    StopOptions stop;
    CheckpointOptions checkpoint;
    bool double_precision = false;           ///< --precision double
    std::optional<std::uint64_t> max_memory; ///< bytes, on the host and the device together
    bool check = false;
    std::string stats;         ///< JSON file, or empty
    bool profile = false;      ///< print the table
    std::string profile_trace; ///< JSON file, or empty
    bool quiet = false;
    bool verbose = false;
    std::string kernel_dir; ///< kernel sources to use instead of the embedded ones, or empty
    int batch = 0;          ///< samples of a pixel in one launch; 0: the program chooses
    int tile = 0;           ///< pixel groups in one launch; 0: the program chooses
    int band_rows = 0;      ///< rows of tiles in one band; 0: the program chooses
    bool preview = false;   ///< a few samples of all pixels first, whatever the size
    CompareOptions compare;
    TestOptions test;
};

/// Either `options`, or the exit code to end with at once: 0 after --help and --version, 2 after a
/// mistake, which one line on stderr has explained.
struct ParseResult {
    std::optional<Options> options;
    int exit_code = 0;
};

ParseResult parse_options(int argc, const char *const *argv);

} // namespace clrender::cli
