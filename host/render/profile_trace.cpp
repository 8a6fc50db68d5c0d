#include "profile_trace.h"

#include "output_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace clrender {

namespace {

using Json = nlohmann::ordered_json;

constexpr int process = 1;
constexpr int host_track = 1;
constexpr int device_track = 2;

/// The format counts in microseconds.
double micro(double seconds) {
    return seconds * 1e6;
}

Json name_event(const char *what, int track, const std::string &name) {
    return {
        {"ph", "M"}, {"pid", process}, {"tid", track}, {"name", what}, {"args", {{"name", name}}}};
}

Json slice_event(const char *category, int track, const std::string &name, double start,
                 double end) {
    return {{"ph", "X"},
            {"pid", process},
            {"tid", track},
            {"cat", category},
            {"name", name},
            {"ts", micro(start)},
            {"dur", micro(end - start)}};
}

Json command_event(const ProfileCommand &command) {
    Json event = slice_event(command.is_kernel ? "kernel" : "copy", device_track, command.name,
                             command.start, command.end);
    Json args = {{"pass", command.pass + 1},
                 {"queued_us_before", micro(command.start - command.queued)},
                 {"submitted_us_before", micro(command.start - command.submitted)}};
    if (command.is_kernel) {
        args["tiles"] = command.items;
        args["colour"] = command.colour;
    }
    event["args"] = args;
    return event;
}

Json counter_event(const char *name, double time, const Json &values) {
    return {{"ph", "C"},    {"pid", process},    {"tid", device_track},
            {"name", name}, {"ts", micro(time)}, {"args", values}};
}

/// The counters from `time` on; all zero without a pass.
void add_counters(Json &events, const Profile &profile, double time, const ProfileSums &sums) {
    const ProfileCounts &c = sums.counts;
    const auto per_second = [&](double amount) { return ratio(amount, sums.device_seconds); };
    events.push_back(counter_event(
        "million rays a second", time,
        {{"camera", per_second(c[PROFILE_CAMERA_RAYS] * 1e-6)},
         {"bounce", per_second((c[PROFILE_PATH_RAYS] - c[PROFILE_CAMERA_RAYS]) * 1e-6)},
         {"shadow", per_second(c[PROFILE_SHADOW_RAYS] * 1e-6)}}));
    events.push_back(counter_event(
        "lanes alive, %", time, {{"bounce loop", 100 * lane_occupancy(c, profile.config.LANES)}}));
    events.push_back(
        counter_event("nodes a ray", time,
                      {{"path", path_nodes_per_ray(c)}, {"shadow", shadow_nodes_per_ray(c)}}));
    events.push_back(
        counter_event("blocks a ray", time,
                      {{"path", path_blocks_per_ray(c)}, {"shadow", shadow_blocks_per_ray(c)}}));
    events.push_back(counter_event(
        "% of peak (estimate)", time,
        {{"float operations",
          percent(per_second(float_operations(c, profile.config)), profile.peak.flops)},
         {"tree bytes", percent(per_second(tree_bytes(c)), profile.peak.bandwidth)}}));
}

void add_device(Json &events, const Profile &profile) {
    std::size_t next_pass = 0;
    for (const ProfileCommand &command : profile.commands) {
        if (command.pass == next_pass) {
            add_counters(events, profile, command.start,
                         profile_sums(profile, next_pass, next_pass + 1));
            ++next_pass;
        }
        events.push_back(command_event(command));
    }
    if (!profile.commands.empty())
        add_counters(events, profile, profile.commands.back().end, {});
}

/// The sums of all passes, for programs that read the file.
Json summary(const Profile &profile) {
    Json json = {{"device", profile.device},
                 {"lanes", profile.config.LANES},
                 {"features", profile.config.describe()},
                 {"peak_flops", profile.peak.flops},
                 {"peak_bytes_per_second", profile.peak.bandwidth},
                 {"uploaded_bytes", profile.uploaded_bytes},
                 {"downloaded_bytes", profile.downloaded_bytes},
                 {"device_bytes", profile.device_bytes}};
    if (profile.passes.empty())
        return json;
    const ProfileSums all = profile_sums(profile, 0, profile.passes.size());
    const ProfileCounts &c = all.counts;
    json["device_seconds"] = all.device_seconds;
    json["gap_seconds"] = all.gap_seconds;
    json["camera_rays"] = c[PROFILE_CAMERA_RAYS];
    json["bounce_rays"] = c[PROFILE_PATH_RAYS] - c[PROFILE_CAMERA_RAYS];
    json["shadow_rays"] = c[PROFILE_SHADOW_RAYS];
    json["packets"] = c[PROFILE_PACKETS];
    json["packet_rays"] = c[PROFILE_PACKET_RAYS];
    json["tree_nodes"] = tree_nodes(c);
    json["tree_blocks"] = tree_blocks(c);
    json["lanes_alive"] = lane_occupancy(c, profile.config.LANES);
    json["shadow_lanes_alive"] = shadow_occupancy(c, profile.config.LANES);
    json["path_nodes_per_ray"] = path_nodes_per_ray(c);
    json["path_blocks_per_ray"] = path_blocks_per_ray(c);
    json["shadow_nodes_per_ray"] = shadow_nodes_per_ray(c);
    json["shadow_blocks_per_ray"] = shadow_blocks_per_ray(c);
    json["tree_bytes_read"] = tree_bytes(c);
    json["float_operations"] = float_operations(c, profile.config);
    return json;
}

} // namespace

void write_profile_trace(const std::string &path, const Profile &profile) {
    Json events = {name_event("process_name", host_track, "clrender"),
                   name_event("thread_name", host_track, "host"),
                   name_event("thread_name", device_track, profile.device)};
    for (const ProfilePhase &phase : profile.phases)
        events.push_back(slice_event("host", host_track, phase.name, phase.start, phase.end));
    add_device(events, profile);
    const Json trace = {{"displayTimeUnit", "ms"},
                        {"otherData", summary(profile)},
                        {"traceEvents", std::move(events)}};
    write_output_file(path, trace.dump() + '\n');
}

} // namespace clrender
