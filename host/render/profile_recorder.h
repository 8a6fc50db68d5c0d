#pragma once
/// Fills a Profile while the device works: the times of its commands and the kernel's counts.

#include "device/cl_context.h"
#include "launch_plan.h"
#include "profile.h"
#include "shared/profile_data.h"

#include <cstdint>
#include <deque>

namespace clrender {

/// The queue has to have been made with CL_QUEUE_PROFILING_ENABLE and to be in order.
class ProfileRecorder {
public:
    /// Allocates and clears the counts.
    ProfileRecorder(Profile &profile, const cl::Context &context, const cl::CommandQueue &queue);

    /// What the kernel adds its counts to, and how large it is.
    [[nodiscard]] const cl::Buffer &buffer() const { return buffer_; }
    static constexpr std::size_t bytes() { return PROFILE_SLOTS * sizeof(ProfileCounters); }

    /// To be called once `launch` is in the queue. The counts are read behind the last of each
    /// pass.
    void enqueued(const LaunchPlan::Launch &launch);
    /// The oldest launch has ended; the host began to enqueue it at `called`.
    void finished(const LaunchPlan::Launch &launch, const cl::Event &event,
                  Profile::Clock::time_point called);
    /// No launch is under way any more; there were `spp` samples to do. Completes the profile.
    void complete(int spp);

private:
    struct Read {
        std::vector<ProfileCounters> counters;
        cl::Event event;
    };

    void read_counts();
    void take_counts(int first_block, int end_block);
    void add_command(ProfileCommand command, const cl::Event &event);

    Profile &profile_;
    const cl::CommandQueue &queue_;
    cl::Buffer buffer_;
    std::deque<Read> reads_;
    ProfileCounts before_{}; ///< the counts of all passes that have ended
    bool pass_ended_ = true;
    int first_block_ = 0, end_block_ = 0; ///< of the pass that has not ended
    /// From the device's clock to seconds since the origin: the largest that lets no command be
    /// queued before the host has asked for it.
    double clock_offset_ = -1e300;
};

} // namespace clrender
