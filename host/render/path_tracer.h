#pragma once
/// The device's side of a render: the film there, and the launches that fill it.

#include "device/device_scene.h"
#include "device/kernel_program.h"
#include "flatten/flat_scene.h"
#include "launch_plan.h"
#include "profile_recorder.h"
#include "render.h"

#include <chrono>
#include <future>
#include <memory>

namespace clrender::inline CLR_PRECISION {

/// The side of a work-item's square. Splatted filters need one that reaches no further than the
/// next.
int tile_of(const DeviceEntry &entry, const KernelConfig &config);

/// What the device keeps of a picture: its pixels, and a record for each work-item's tile.
struct FilmExtent {
    std::size_t pixels, tiles_x, tiles_y;

    FilmExtent(const FrameData &frame, std::size_t tile)
        : pixels(static_cast<std::size_t>(frame.width) * frame.height),
          tiles_x((frame.width + tile - 1) / tile), tiles_y((frame.height + tile - 1) / tile) {}

    [[nodiscard]] std::size_t tiles() const { return tiles_x * tiles_y; }
    [[nodiscard]] std::size_t film_bytes() const { return pixels * sizeof(FilmPixel); }
    [[nodiscard]] std::size_t counter_bytes() const { return tiles() * sizeof(ItemCounters); }
    [[nodiscard]] std::size_t bytes() const { return film_bytes() + counter_bytes(); }
};

/// One render: the device's side of the film and the launches that fill it.
class PathTracer {
public:
    PathTracer(const DeviceEntry &entry, const FlatScene &flat, const RenderOptions &options);

    /// Starts to compile, on a thread of its own.
    void start_compiling();
    /// Waits for the kernel.
    void compile(RenderStats &stats);
    void upload(RenderStats &stats);
    /// True if it was stopped.
    bool render(int spp);
    void read(RenderResult &result, PixelFormat format);
    /// What is left for the profile, if there is one, after all else.
    void complete_profile(const RenderStats &stats);

private:
    struct Pending {
        LaunchPlan::Launch launch;
        cl::Event event;
        std::chrono::steady_clock::time_point start;
    };

    void enqueue(const LaunchPlan::Launch &launch, cl::Event *event);
    void finish(Pending &pending, LaunchPlan &plan, int spp);

    const DeviceEntry &entry_;
    const FlatScene &flat_;
    const RenderOptions &options_;
    FilmExtent extent_;
    ControlLayout control_layout_;
    std::size_t group_;
    cl::Context context_;
    cl::CommandQueue queue_;
    std::future<BuiltKernel> compiling_;
    cl::Kernel kernel_;
    cl_uint launch_arguments_ = 0;
    std::unique_ptr<DeviceScene> scene_;
    cl::Buffer film_, counters_, control_;
    std::unique_ptr<ProfileRecorder> recorder_; ///< where a profile is wanted
    double paths_done_ = 0;
    std::chrono::steady_clock::time_point last_finish_{};
};

} // namespace clrender::inline CLR_PRECISION
