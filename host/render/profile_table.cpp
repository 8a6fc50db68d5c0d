#include "profile.h"

#include <algorithm>
#include <fmt/core.h>

namespace clrender {

namespace {

/// Passes beyond these share rows.
constexpr std::size_t most_rows = 16;

/// 1536 B, 1.50 MiB.
std::string bytes_text(double bytes) {
    constexpr std::array units = {"B", "KiB", "MiB", "GiB", "TiB"};
    std::size_t unit = 0;
    while (bytes >= 1024 && unit + 1 < units.size()) {
        bytes /= 1024;
        ++unit;
    }
    return unit == 0 ? fmt::format("{:.0f} B", bytes)
                     : fmt::format("{:.2f} {}", bytes, units[unit]);
}

constexpr const char *header =
    "pass     samples  launches  device s   gaps s  queued s |  camera  bounce  shadow |"
    "  nodes  blocks | lanes |  flop  bytes\n"
    "                                                        |           million rays  |"
    "        a ray   |     % |       % of peak\n";

/// One line of the table.
std::string row(const Profile &profile, const std::string &name, const ProfileSums &sums) {
    const ProfileCounts &c = sums.counts;
    const double rays = total_rays(c);
    const double seconds = sums.device_seconds;
    return fmt::format("{:<5}{:>11}{:>10.0f}{:>10.4f}{:>9.4f}{:>10.4f} |{:>8.3f}{:>8.3f}{:>8.3f} "
                       "|{:>7.2f}{:>8.2f} "
                       "|{:>6.1f} |{:>6.1f}{:>7.1f}\n",
                       name, fmt::format("{}-{}", sums.first_sample, sums.end_sample - 1),
                       sums.launches, seconds, sums.gap_seconds, sums.queue_seconds,
                       c[PROFILE_CAMERA_RAYS] * 1e-6,
                       (c[PROFILE_PATH_RAYS] - c[PROFILE_CAMERA_RAYS]) * 1e-6,
                       c[PROFILE_SHADOW_RAYS] * 1e-6, ratio(tree_nodes(c), rays),
                       ratio(tree_blocks(c), rays), 100 * lane_occupancy(c, profile.config.LANES),
                       percent(float_operations(c, profile.config), seconds * profile.peak.flops),
                       percent(tree_bytes(c), seconds * profile.peak.bandwidth));
}

std::string rows(const Profile &profile) {
    std::string text = header;
    const std::size_t count = profile.passes.size();
    const std::size_t step = (count + most_rows - 1) / most_rows;
    for (std::size_t first = 0; first < count; first += step) {
        const std::size_t end = std::min(first + step, count);
        const std::string name =
            end - first == 1 ? fmt::format("{}", first + 1) : fmt::format("{}-{}", first + 1, end);
        text += row(profile, name, profile_sums(profile, first, end));
    }
    return text;
}

/// What the sums of all passes say.
std::string details(const Profile &profile, const ProfileSums &all) {
    const ProfileCounts &c = all.counts;
    const int lanes = profile.config.LANES;
    const double flop = float_operations(c, profile.config);
    const double bytes = tree_bytes(c);
    const double seconds = all.device_seconds;
    std::string text;
    text += fmt::format("rays               {:.4g} million a second of device time\n",
                        ratio(total_rays(c) * 1e-6, seconds));
    text += fmt::format("camera and bounce  {:.2f} nodes and {:.2f} blocks a ray\n",
                        path_nodes_per_ray(c), path_blocks_per_ray(c));
    text += fmt::format("shadow             {:.2f} nodes and {:.2f} blocks a ray\n",
                        shadow_nodes_per_ray(c), shadow_blocks_per_ray(c));
    if (c[PROFILE_PACKETS] > 0)
        text += fmt::format("packets            {:.1f}% of the camera rays, {:.1f} in each\n",
                            percent(c[PROFILE_PACKET_RAYS], c[PROFILE_CAMERA_RAYS]),
                            c[PROFILE_PACKET_RAYS] / c[PROFILE_PACKETS]);
    text += fmt::format("lanes alive        {:.1f}% of {} in the bounce loop, {:.1f}% where shadow "
                        "rays are traced\n",
                        100 * lane_occupancy(c, lanes), lanes, 100 * shadow_occupancy(c, lanes));
    text += fmt::format("memory             {} uploaded, {} downloaded, {} on the device\n",
                        bytes_text(profile.uploaded_bytes), bytes_text(profile.downloaded_bytes),
                        bytes_text(profile.device_bytes));
    text += fmt::format("nodes and blocks   {} read (estimate), {}/s: {:.1f}% of {}/s that the "
                        "device streams\n",
                        bytes_text(bytes), bytes_text(ratio(bytes, seconds)),
                        percent(bytes, seconds * profile.peak.bandwidth),
                        bytes_text(profile.peak.bandwidth));
    text += fmt::format("float operations   {:.4g} billion (estimate), {:.4g} billion a second: "
                        "{:.1f}% of {:.4g} that the device reaches\n",
                        flop * 1e-9, ratio(flop * 1e-9, seconds),
                        percent(flop, seconds * profile.peak.flops), profile.peak.flops * 1e-9);
    return text;
}

} // namespace

std::string profile_table(const Profile &profile) {
    std::string text =
        fmt::format("kernel path_trace on {}, {} lanes\n", profile.device, profile.config.LANES);
    if (profile.passes.empty())
        return text + "no launch was finished\n";
    const ProfileSums all = profile_sums(profile, 0, profile.passes.size());
    return text + rows(profile) + row(profile, "all", all) + details(profile, all);
}

} // namespace clrender
