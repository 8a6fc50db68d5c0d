#pragma once
/// From a parsed scene to a picture.

#include "device/kernel_config.h"
#include "scene/scene.h"

#include <cstdint>
#include <functional>
#include <set>
#include <string>

namespace clrender {

struct Profile;

struct RenderOptions {
    int spp = 0; ///< samples a pixel; 0: the scene's
    std::uint32_t seed = 0;
    int lanes = 0;                    ///< 1, 4, 8 or 16; 0: what suits the device
    std::string device = "auto";      ///< see choose_device()
    bool double_precision = false;    ///< all in double, with one lane: slow
    bool brute_force = false;         ///< test every triangle
    bool pixel_centers = false;       ///< all samples at pixel centres
    bool independent_sampler = false; ///< in place of Sobol' points
    Strategy strategy = Strategy::mis;
    int light_samples = 0;            ///< where a path first meets a diffuse surface: a power
                                      ///< of 2; 0: chosen
    int batch = 0;                    ///< blocks of samples in one launch; 0: chosen
    int tile = 0;                     ///< work-items in one launch; 0: chosen
    int band_rows = 0;                ///< rows of tiles in one band; 0: chosen
    bool preview = false;             ///< a few samples of all pixels first, however fast
    bool with_variance = false;       ///< RenderResult::variance is wanted
    std::set<std::string> generality; ///< as FlattenOptions::generality
    std::string kernel_dir;           ///< kernel sources in place of the embedded ones
    Profile *profile = nullptr;       ///< filled where given, with a kernel that counts
    std::function<void(double)> on_progress; ///< paths done; called after each launch
    std::function<bool()> should_stop;       ///< asked after each launch
};

/// What a run tells of itself. Seconds are wall time.
struct RenderStats {
    std::string device;
    int lanes = 0;
    int width = 0, height = 0;
    int spp = 0; ///< samples every pixel has
    double paths = 0, rays = 0;
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

/// `image` has the channels of the film's pixel format; `variance`, where it is wanted, has as many
/// and holds the estimated variance of each pixel's mean (of luminance: an upper bound).
struct RenderResult {
    Image image;
    Image variance;
    RenderStats stats;
    bool interrupted = false;
    std::size_t gaps = 0; ///< pixels without a sample, which show their neighbours
};

/// Bytes that rendering the scene takes on a device: what is uploaded, and the film. Needs no
/// device.
std::size_t device_bytes_needed(const Scene &scene, const RenderOptions &options = {});

/// Flattens, compiles, uploads and renders. Throws DeviceError.
RenderResult render_scene(const Scene &scene, const RenderOptions &options = {});

/// The same, and frees the shapes and images of the scene as soon as they are flattened.
RenderResult render_scene(Scene &&scene, const RenderOptions &options = {});

} // namespace clrender
