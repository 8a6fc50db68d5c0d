#pragma once
/// From a parsed scene to a picture.

#include "config/sampling_options.h"
#include "film/aov_sums.h"
#include "film/checkpoint.h"
#include "film/control.h"
#include "memory_need.h"
#include "render_progress.h"
#include "scene/scene.h"
#include "stopping_rule.h"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>

namespace clrender {

struct Profile;

/// Layers of first hits beside those that the scene asks for.
struct LayerOptions {
    std::vector<Aov> aovs; ///< by pixels, not by the filter
    bool matte = false;    ///< Cryptomatte
};

struct RenderOptions {
    int spp = 0; ///< samples a pixel, at most; 0: the scene's
    /// When the picture has to be written; 0: any time. It ends with as many samples in every pixel
    /// as fit into that, one at least.
    std::chrono::steady_clock::time_point deadline{};
    /// Seconds that writing a picture like this one takes, for the deadline; asked once.
    std::function<double(const Image &)> seconds_to_write;
    /// The relative error (ErrorEstimate) that ends the render; 0: none. Needs the variance.
    double target_error = 0;
    std::uint32_t seed = 0;
    int lanes = 0;                 ///< 1, 4, 8 or 16; 0: what suits the device
    std::string device = "auto";   ///< see choose_device()
    bool double_precision = false; ///< all in double, with one lane: slow
    SamplingOptions sampling;
    int batch = 0;              ///< blocks of samples in one launch; 0: chosen
    int tile = 0;               ///< work-items in one launch; 0: chosen
    int band_rows = 0;          ///< rows of tiles in one band; 0: chosen
    bool preview = false;       ///< a few samples of all pixels first, however fast
    bool with_variance = false; ///< RenderResult::variance and error are wanted
    bool with_samples = false;  ///< RenderResult::samples is wanted
    LayerOptions layers;
    std::string kernel_dir;     ///< kernel sources in place of the embedded ones
    Profile *profile = nullptr; ///< filled where given, with a kernel that counts
    std::function<void(const RenderProgress &)> on_progress; ///< called after each launch
    std::function<bool()> should_stop;                       ///< asked after each launch
    /// Goes on from here: the same scene and options, but for `spp` and what else ends a render.
    std::shared_ptr<const Checkpoint> resumed;
    int part = 1, parts = 1; ///< of the samples, which end with a block: part_of_work()
    /// Gets the sums, without `options`, and the picture, whenever checkpoint_due() says so after a
    /// launch, and at the end.
    std::function<void(const Checkpoint &, const Image &)> write_checkpoint;
    std::function<bool()> checkpoint_due;
};

/// What a run tells of itself. Seconds are wall time.
struct RenderStats {
    std::string device;
    int lanes = 0;
    int width = 0, height = 0;
    int spp = 0; ///< samples every pixel has
    double paths = 0, rays = 0;
    double paths_before = 0; ///< of the checkpoint that it went on from
    double seconds_device = 0, seconds_build = 0, seconds_compile = 0, seconds_upload = 0,
           seconds_render = 0;
    std::string kernel_features;
    bool kernel_cached = false;
    double seconds_kernel = 0; ///< compiling or fetching it, while the hierarchy was being built
    std::size_t host_bytes = 0, device_bytes = 0;
    std::size_t triangles = 0;
    double nonfinite_samples = 0;
    int nonfinite_x = 0, nonfinite_y = 0; ///< the first pixel that had one
    std::size_t clamped_pixels = 0;       ///< with sums beyond the film's range (FilmPixel)
    int clamped_x = 0, clamped_y = 0;     ///< the first of them
};

/// What a render knows of its own noise; not of what is wrong in every render alike.
struct ErrorEstimate {
    /// The mean over pixels and colour channels of variance / (value^2 + .01): the expected relMSE
    /// against a picture without noise. Infinite where a pixel has fewer than two samples.
    /// Not a number where the variance is not wanted.
    double relative_variance = std::numeric_limits<double>::quiet_NaN();
    /// The variance over that of independent samples, as the control tiles tell.
    VarianceFactor factor;

    /// The relative error of the picture, as far as it is noise.
    [[nodiscard]] double relative_error() const { return std::sqrt(relative_variance); }
};

/// `image` has the channels of the film's pixel format; `variance`, where it is wanted, has as many
/// and holds the estimated variance of each pixel's mean (of luminance: an upper bound), infinite
/// where there are fewer than two samples. Neighbouring pixels share samples where the filter is
/// wider than a pixel, so their errors agree: the variances do not add up to that of a sum of
/// pixels. `samples` has one channel: the samples that lie in each pixel.
struct RenderResult {
    Image image;
    Image variance;
    Image samples;
    std::vector<NamedLayer> layers; ///< of first hits: the scene's, then those of LayerOptions
    std::map<std::string, std::string> layer_metadata; ///< what a file has to say of them
    ErrorEstimate error;                               ///< where the variance is wanted
    RenderStats stats;
    bool interrupted = false;
    StopReason ended_by = StopReason::samples; ///< unless interrupted
    std::size_t gaps = 0; ///< pixels without a sample, which show their neighbours
};

/// What rendering the scene takes, where the kernel does not have to be compiled. Needs no device;
/// frees the shapes and images of the scene.
MemoryNeed memory_needed(Scene &&scene, const RenderOptions &options = {});

/// Flattens, compiles, uploads and renders. Throws DeviceError.
RenderResult render_scene(const Scene &scene, const RenderOptions &options = {});

/// The same, and frees the shapes and images of the scene as soon as they are flattened.
RenderResult render_scene(Scene &&scene, const RenderOptions &options = {});

/// A render that is looked at and goes on. The picture of N samples is, to the bit, that of a
/// render of N samples in all, where a block of samples ends at N (film_blocks.h).
class AdvancingRender {
public:
    virtual ~AdvancingRender() = default;

    /// Renders until every pixel has `samples` samples, rounded up to the end of a block, or
    /// RenderOptions::spp, which is the end. Returns false if it was stopped before: it cannot go
    /// on then.
    virtual bool advance(int samples) = 0;
    /// Samples that every pixel has.
    [[nodiscard]] virtual int samples() const = 0;
    /// The picture as it stands.
    virtual RenderResult read() = 0;
};

/// Flattens, compiles and uploads; takes no sample yet. Throws DeviceError, also where the picture
/// is so large that it is rendered in bands.
std::unique_ptr<AdvancingRender> start_render(Scene &&scene, const RenderOptions &options = {});

} // namespace clrender
