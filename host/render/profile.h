#pragma once
/// What --profile measures of a render, and the figures that follow from it.

#include "config/kernel_config.h"
#include "shared/profile_data.h"

#include <array>
#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

namespace clrender {

/// By ProfileCounter.
using ProfileCounts = std::array<double, PROFILE_COUNTERS>;

/// A step of the program. Times here and below are seconds since Profile::origin.
struct ProfilePhase {
    std::string name;
    double start = 0, end = 0;
};

/// One command of the device's queue, by its OpenCL event: when it was put into the queue, handed
/// to the device, begun and ended.
struct ProfileCommand {
    std::string name; ///< the kernel's, or what is copied
    bool is_kernel = false;
    std::size_t pass = 0;
    std::size_t items = 0; ///< tiles
    unsigned colour = 0;   ///< of the tiles, as CLR_ALL_TILES says
    double queued = 0, submitted = 0, start = 0, end = 0;
};

/// A pass over the picture: samples [first_sample, end_sample) of every pixel, and what was
/// counted.
struct ProfilePass {
    int first_sample = 0, end_sample = 0;
    ProfileCounts counts{};
};

/// What probe kernels reached on this device: float operations (an fma is two) and bytes read,
/// a second.
struct DevicePeak {
    double flops = 0;
    double bandwidth = 0;
};

struct Profile {
    using Clock = std::chrono::steady_clock;

    Clock::time_point origin = Clock::now();
    std::string device;
    KernelConfig config;
    std::vector<ProfilePhase> phases;
    std::vector<ProfileCommand> commands; ///< in the order of the queue
    std::vector<ProfilePass> passes;
    DevicePeak peak;
    double uploaded_bytes = 0, downloaded_bytes = 0, device_bytes = 0;

    [[nodiscard]] double seconds(Clock::time_point time) const {
        return std::chrono::duration<double>(time - origin).count();
    }
    void add_phase(const std::string &name, Clock::time_point start, Clock::time_point end) {
        phases.push_back({name, seconds(start), seconds(end)});
    }
};

/// The figures of some passes, one after the other.
struct ProfileSums {
    int first_sample = 0, end_sample = 0;
    double launches = 0;
    double device_seconds = 0; ///< that kernels ran
    double gap_seconds = 0;    ///< that the device ran nothing, before and between the commands
    double queue_seconds = 0;  ///< from each launch's call to its begin, added up
    ProfileCounts counts{};
};

/// Of the passes [first, end), at least one.
ProfileSums profile_sums(const Profile &profile, std::size_t first, std::size_t end);

/// 0 where there is no whole.
double ratio(double part, double whole);
double percent(double part, double whole);

double total_rays(const ProfileCounts &counts);
/// Mean share of the lanes that are alive in an iteration of the bounce loop.
double lane_occupancy(const ProfileCounts &counts, int lanes);
/// The same in those iterations where any lane traces a shadow ray; 0 without shadow rays.
double shadow_occupancy(const ProfileCounts &counts, int lanes);
/// Nodes or blocks of one kind of ray, a ray; 0 without such rays. What the rays of a packet visit
/// together counts once.
double path_nodes_per_ray(const ProfileCounts &counts);
double path_blocks_per_ray(const ProfileCounts &counts);
double shadow_nodes_per_ray(const ProfileCounts &counts);
double shadow_blocks_per_ray(const ProfileCounts &counts);

/// Nodes and blocks that rays of all kinds visited, and their bytes. An estimate: most of them come
/// from caches.
double tree_nodes(const ProfileCounts &counts);
double tree_blocks(const ProfileCounts &counts);
double tree_bytes(const ProfileCounts &counts);
/// Float operations, estimated by a constant for each test and each bounce (docs/manual.md).
double float_operations(const ProfileCounts &counts, const KernelConfig &config);

/// The table that --profile prints.
std::string profile_table(const Profile &profile);

} // namespace clrender
