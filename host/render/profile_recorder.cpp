#include "profile_recorder.h"

#include "shared/launch_data.h"

#include <algorithm>

namespace clrender {

namespace {

double event_seconds(const cl::Event &event, cl_profiling_info what) {
    cl_ulong nanoseconds = 0;
    event.getProfilingInfo(what, &nanoseconds);
    return static_cast<double>(nanoseconds) * 1e-9;
}

ProfileCounts sum_of_slots(const std::vector<ProfileCounters> &slots) {
    ProfileCounts sums{};
    for (const ProfileCounters &slot : slots)
        for (std::size_t i = 0; i < sums.size(); ++i)
            sums[i] += slot.count[i][0] + 4294967296.0 * slot.count[i][1];
    return sums;
}

} // namespace

ProfileRecorder::ProfileRecorder(Profile &profile, const cl::Context &context,
                                 const cl::CommandQueue &queue)
    : profile_(profile), queue_(queue) {
    with_device("clearing the counters", [&] {
        buffer_ = cl::Buffer(context, CL_MEM_READ_WRITE, bytes());
        queue_.enqueueFillBuffer(buffer_, cl_uint{0}, 0, bytes());
    });
}

void ProfileRecorder::enqueued(const LaunchPlan::Launch &launch) {
    if (launch.ends_pass)
        read_counts();
}

void ProfileRecorder::read_counts() {
    Read &read = reads_.emplace_back();
    read.counters.resize(PROFILE_SLOTS);
    with_device("reading the counters", [&] {
        queue_.enqueueReadBuffer(buffer_, CL_FALSE, 0, bytes(), read.counters.data(), nullptr,
                                 &read.event);
        queue_.flush();
    });
}

void ProfileRecorder::finished(const LaunchPlan::Launch &launch, const cl::Event &event,
                               Profile::Clock::time_point called) {
    const double queued = with_device(
        "asking for times", [&] { return event_seconds(event, CL_PROFILING_COMMAND_QUEUED); });
    clock_offset_ = std::max(clock_offset_, profile_.seconds(called) - queued);
    ProfileCommand command;
    command.name = "path_trace";
    command.is_kernel = true;
    command.items = launch.item_count;
    command.colour = launch.colour;
    add_command(command, event);

    pass_ended_ = launch.ends_pass;
    first_block_ = launch.first_block;
    end_block_ = launch.end_block;
    if (launch.ends_pass)
        take_counts(first_block_, end_block_);
}

/// The oldest read belongs to the pass that has just ended.
void ProfileRecorder::take_counts(int first_block, int end_block) {
    Read &read = reads_.front();
    with_device("reading the counters", [&] { read.event.wait(); });
    ProfileCommand command;
    command.name = "read counters";
    add_command(command, read.event);
    profile_.downloaded_bytes += static_cast<double>(bytes());

    const ProfileCounts now = sum_of_slots(read.counters);
    ProfilePass pass;
    pass.first_sample = CLR_BLOCK_START(first_block);
    pass.end_sample = CLR_BLOCK_START(end_block);
    for (std::size_t i = 0; i < now.size(); ++i)
        pass.counts[i] = now[i] - before_[i];
    before_ = now;
    profile_.passes.push_back(pass);
    reads_.pop_front();
}

/// The times are the device's until complete() moves them.
void ProfileRecorder::add_command(ProfileCommand command, const cl::Event &event) {
    command.pass = profile_.passes.size();
    with_device("asking for times", [&] {
        command.queued = event_seconds(event, CL_PROFILING_COMMAND_QUEUED);
        command.submitted = event_seconds(event, CL_PROFILING_COMMAND_SUBMIT);
        command.start = event_seconds(event, CL_PROFILING_COMMAND_START);
        command.end = event_seconds(event, CL_PROFILING_COMMAND_END);
    });
    profile_.commands.push_back(std::move(command));
}

void ProfileRecorder::complete(int spp) {
    // An interrupted pass counts as far as it got.
    if (!pass_ended_) {
        read_counts();
        take_counts(first_block_, end_block_);
    }
    for (ProfilePass &pass : profile_.passes)
        pass.end_sample = std::min(pass.end_sample, spp);
    for (ProfileCommand &command : profile_.commands)
        for (double *time : {&command.queued, &command.submitted, &command.start, &command.end})
            *time += clock_offset_;
}

} // namespace clrender
