#pragma once
/// The device's side of a render: the film there, and the launches that fill it.

#include "bands.h"
#include "config/kernel_config.h"
#include "device/kernel_program.h"
#include "device_film.h"
#include "device_scene.h"
#include "film/checkpoint.h"
#include "flatten/flat_scene.h"
#include "launch_plan.h"
#include "picture.h"
#include "profile_recorder.h"
#include "render.h"

#include <chrono>
#include <functional>
#include <future>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace clrender::inline CLR_PRECISION {

/// How many children of a node the device tests at once (BVH_STEP).
int bvh_step_for(const DeviceEntry &entry);

/// The side of a work-item's square that suits the device, where filters are not splatted.
int tile_for(const DeviceEntry &entry);

/// The tiles of the picture that a kernel of this kind renders.
PictureTiles tiles_of(const FrameData &frame, const KernelConfig &config);

/// The bands that the device renders the picture in.
std::vector<Band> bands_of(const DeviceEntry &entry, const PictureTiles &tiles,
                           const RenderOptions &options);

/// One render: the device's side of the film and the launches that fill it.
class PathTracer {
public:
    /// Frees the arrays of `flat` as they are uploaded; its frame stays.
    PathTracer(const DeviceEntry &entry, FlatScene &flat, const KernelConfig &config,
               const RenderOptions &options);

    /// From now on asks after each launch whether a checkpoint is due, and has it written then.
    void on_checkpoint(std::function<bool()> is_due, std::function<void()> write) {
        is_checkpoint_due_ = std::move(is_due);
        write_checkpoint_ = std::move(write);
    }
    /// Starts to compile, on a thread of its own.
    void start_compiling();
    /// Waits for the kernel.
    void compile(RenderStats &stats);
    void upload(RenderStats &stats);
    /// Renders `spp` samples a pixel into `picture`; true if it was stopped before that.
    bool render(int spp, Picture &picture, RenderStats &stats);
    enum class Ended { done, stopped, slow };
    static constexpr double no_limit = std::numeric_limits<double>::infinity();
    /// Goes on from `done` samples a pixel, all of which are whole blocks, to `spp` of them; only
    /// for pictures in one band, and only with no call of render(). Where `spp` lies within a block
    /// the next call begins with the same `done`: what was rendered beyond it is forgotten.
    /// Stopped, tiles have different numbers of samples: it cannot go on then. Ends as `slow`, from
    /// where it can go on, where the first pass turns out to take longer than `slow_seconds`.
    Ended go_on(int done, int spp, double slow_seconds = no_limit);
    /// What the film's sums mean; `format`: of the picture.
    [[nodiscard]] FilmLayout layout(PixelFormat format) const;
    /// Renders these pieces, all of whole blocks, beside what is there.
    Ended add(Work pieces);
    /// The sums of a checkpoint become the film's, which is empty.
    void load(const Checkpoint &checkpoint);
    /// The sums of all whole blocks that are there, and which they are; without `options`. Only
    /// between launches: where on_checkpoint() calls, or no other call is under way.
    [[nodiscard]] Checkpoint checkpoint(PixelFormat format) const;
    /// Takes the film as the last call has left it over.
    void read(Picture &picture, RenderStats &stats);
    /// Samples that every pixel has.
    [[nodiscard]] int samples_of_all() const;
    /// Paths that have been traced.
    [[nodiscard]] double paths() const { return paths_done_; }
    /// Whether the picture is rendered in one band.
    [[nodiscard]] bool in_one_piece() const { return bands_.size() == 1; }
    [[nodiscard]] const cl::Context &context() const { return context_; }
    [[nodiscard]] const cl::CommandQueue &queue() const { return queue_; }
    /// After upload().
    [[nodiscard]] const DeviceScene &scene() const { return *scene_; }
    [[nodiscard]] const ControlLayout &control_layout() const { return control_; }
    /// The control tiles of the picture as it stands.
    [[nodiscard]] std::vector<ControlPixel> read_control() const { return film_->read_control(); }
    /// Seconds of render() and advance() that were spent on reading the film.
    [[nodiscard]] double seconds_read() const { return seconds_read_; }
    /// What is left for the profile, if there is one, after all else.
    void complete_profile(const RenderStats &stats);

private:
    struct Pending {
        LaunchPlan::Launch launch;
        cl::Event event;
        std::chrono::steady_clock::time_point start;
    };
    Ended preview(int spp, Picture &picture, RenderStats &stats);
    Ended render_bands(int spp, double slow_seconds, Picture &picture, RenderStats &stats);
    void take(Picture &picture, const Band &band, const LaunchPlan &plan);
    Ended run(LaunchPlan &plan, double slow_seconds);
    void keep_work();
    [[nodiscard]] Work work() const;
    void enqueue(const LaunchPlan::Launch &launch, cl::Event *event);
    void finish(Pending &pending, LaunchPlan &plan);
    LaunchPlan plan_of(const Band &band, int spp, int first_block = 0);
    void add_counters(RenderStats &stats) const;

    const DeviceEntry &entry_;
    FlatScene &flat_;
    const KernelConfig &config_;
    const RenderOptions &options_;
    PictureTiles tiles_;
    std::vector<Band> bands_;
    ControlLayout control_;
    std::size_t group_;
    cl::Context context_;
    cl::CommandQueue queue_;
    std::future<BuiltKernel> compiling_;
    cl::Kernel kernel_;
    cl_uint launch_arguments_ = 0;
    std::unique_ptr<DeviceScene> scene_;
    std::unique_ptr<DeviceFilm> film_;
    LaunchPace pace_;
    std::function<bool()> is_checkpoint_due_;
    std::function<void()> write_checkpoint_;
    std::unique_ptr<ProfileRecorder> recorder_; ///< where a profile is wanted
    double paths_done_ = 0;                     ///< of the picture as it stands
    double progress_ = 0, progress_total_ = 1;  ///< paths, with those that are traced again
    bool has_samples_ = false;                  ///< a launch has ended
    double seconds_read_ = 0;
    std::chrono::steady_clock::time_point last_finish_{};
    std::optional<LaunchPlan> last_plan_; ///< of go_on() and add()
    Work work_;                           ///< in the film, of whole blocks, before last_plan_
    bool is_beyond_ = false; ///< the film has samples of a part of a block, which go_on() has added
};

} // namespace clrender::inline CLR_PRECISION
