#include "profile.h"

#include "shared/bvh.h"

#include <algorithm>

namespace clrender {

namespace {

/// Float operations of the kernel's parts: additions, subtractions, multiplications, divisions and
/// roots count one, an fma two, comparisons, minima, picks and conversions nothing. Tests are
/// counted from the source, up to where most of them end; the rest is rounded.
constexpr double node_flops = BVH_WIDTH * 6 * 2;        ///< six planes a child
constexpr double triangle_block_flops = BVH_WIDTH * 30; ///< up to the edge functions
constexpr double sphere_block_flops = BVH_WIDTH * 90;   ///< both forms of the discriminant
constexpr double lane_sphere_flops = 24;                ///< a sphere that every ray tests
constexpr double lane_planar_flops = 31;                ///< a rectangle or disk likewise
constexpr double camera_flops = 60;                     ///< a camera ray
constexpr double bounce_flops = 120;                    ///< surface, BSDF and the next ray
constexpr double light_flops = 80;                      ///< a light sample and its weight

/// Visits of nodes and blocks, by all rays; `weight` is what a packet's visit counts.
struct TreeVisits {
    double nodes, triangle_blocks, sphere_blocks;
};

TreeVisits tree_visits(const ProfileCounts &c, double weight) {
    return {c[PROFILE_PATH_NODES] + c[PROFILE_SHADOW_NODES] + weight * c[PROFILE_PACKET_NODES],
            c[PROFILE_PATH_TRIANGLE_BLOCKS] + c[PROFILE_SHADOW_TRIANGLE_BLOCKS] +
                weight * c[PROFILE_PACKET_TRIANGLE_BLOCKS],
            c[PROFILE_PATH_SPHERE_BLOCKS] + c[PROFILE_SHADOW_SPHERE_BLOCKS] +
                weight * c[PROFILE_PACKET_SPHERE_BLOCKS]};
}

} // namespace

double ratio(double part, double whole) {
    return whole > 0 ? part / whole : 0;
}

double percent(double part, double whole) {
    return 100 * ratio(part, whole);
}

ProfileSums profile_sums(const Profile &profile, std::size_t first, std::size_t end) {
    ProfileSums sums;
    sums.first_sample = profile.passes.at(first).first_sample;
    sums.end_sample = profile.passes.at(end - 1).end_sample;
    for (std::size_t pass = first; pass < end; ++pass)
        for (std::size_t i = 0; i < PROFILE_COUNTERS; ++i)
            sums.counts[i] += profile.passes[pass].counts[i];
    // Commands are sorted by pass. The queue runs one at a time: what lies before one is a gap.
    const auto from = std::lower_bound(
        profile.commands.begin(), profile.commands.end(), first,
        [](const ProfileCommand &command, std::size_t pass) { return command.pass < pass; });
    auto last = from == profile.commands.begin() ? from : from - 1;
    for (auto command = from; command != profile.commands.end() && command->pass < end; ++command) {
        if (last != command)
            sums.gap_seconds += std::max(0.0, command->start - last->end);
        last = command;
        if (!command->is_kernel)
            continue;
        ++sums.launches;
        sums.device_seconds += command->end - command->start;
        sums.queue_seconds += command->start - command->queued;
    }
    return sums;
}

double total_rays(const ProfileCounts &counts) {
    return counts[PROFILE_PATH_RAYS] + counts[PROFILE_SHADOW_RAYS];
}

double lane_occupancy(const ProfileCounts &counts, int lanes) {
    return ratio(counts[PROFILE_PATH_RAYS], counts[PROFILE_STEPS] * lanes);
}

double shadow_occupancy(const ProfileCounts &counts, int lanes) {
    return ratio(counts[PROFILE_SHADOW_RAYS], counts[PROFILE_SHADOW_STEPS] * lanes);
}

double path_nodes_per_ray(const ProfileCounts &counts) {
    return ratio(counts[PROFILE_PATH_NODES] + counts[PROFILE_PACKET_NODES],
                 counts[PROFILE_PATH_RAYS]);
}

double path_blocks_per_ray(const ProfileCounts &counts) {
    return ratio(counts[PROFILE_PATH_TRIANGLE_BLOCKS] + counts[PROFILE_PATH_SPHERE_BLOCKS] +
                     counts[PROFILE_PACKET_TRIANGLE_BLOCKS] + counts[PROFILE_PACKET_SPHERE_BLOCKS],
                 counts[PROFILE_PATH_RAYS]);
}

double shadow_nodes_per_ray(const ProfileCounts &counts) {
    return ratio(counts[PROFILE_SHADOW_NODES], counts[PROFILE_SHADOW_RAYS]);
}

double shadow_blocks_per_ray(const ProfileCounts &counts) {
    return ratio(counts[PROFILE_SHADOW_TRIANGLE_BLOCKS] + counts[PROFILE_SHADOW_SPHERE_BLOCKS],
                 counts[PROFILE_SHADOW_RAYS]);
}

double tree_nodes(const ProfileCounts &counts) {
    return tree_visits(counts, 1).nodes;
}

double tree_blocks(const ProfileCounts &counts) {
    const TreeVisits visits = tree_visits(counts, 1);
    return visits.triangle_blocks + visits.sphere_blocks;
}

double tree_bytes(const ProfileCounts &counts) {
    const TreeVisits visits = tree_visits(counts, 1);
    return visits.nodes * sizeof(BvhNode) + visits.triangle_blocks * sizeof(TriangleBlock) +
           visits.sphere_blocks * sizeof(SphereBlock);
}

double float_operations(const ProfileCounts &counts, const KernelConfig &config) {
    const double lane_tests =
        config.SPHERE_COUNT * lane_sphere_flops + config.PLANAR_COUNT * lane_planar_flops;
    const TreeVisits visits = tree_visits(counts, config.LANES);
    return visits.nodes * node_flops + visits.triangle_blocks * triangle_block_flops +
           visits.sphere_blocks * sphere_block_flops + total_rays(counts) * lane_tests +
           counts[PROFILE_CAMERA_RAYS] * camera_flops + counts[PROFILE_BOUNCES] * bounce_flops +
           counts[PROFILE_SHADOW_RAYS] * light_flops;
}

} // namespace clrender
