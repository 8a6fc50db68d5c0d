/// What --profile counts, against what is known of the same render, and that it changes nothing.

#include "render_adapter.h"

#include "render/profile.h"
#include "render/render.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace clrender;
using namespace clrender::test;

namespace {

/// A mesh on a floor below a lamp; the camera sees the sky beside them.
const char *const mesh_scene = R"(
    <integrator type="path"><integer name="max_depth" value="5"/></integrator>
    <sensor type="perspective"><float name="fov" value="40"/>
        <transform name="to_world"><lookat origin="0 1 6" target="0 0 0" up="0 1 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="37"/><integer name="height" value="21"/>
            <rfilter type="box"/></film></sensor>
    <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
        <scale value="3"/><translate y="-1"/></transform></shape>
    <shape type="obj"><string name="filename" value="data/blob.obj"/></shape>
    <shape type="disk"><transform name="to_world"><rotate x="1" angle="90"/>
        <translate y="3"/></transform>
        <emitter type="area"><rgb name="radiance" value="9 8 7"/></emitter></shape>)";

constexpr int spp = 100; // not a whole number of blocks

RenderResult render(Profile *profile, int lanes = 0, bool brute_force = false) {
    RenderOptions options;
    options.spp = spp;
    options.lanes = lanes;
    options.sampling.brute_force = brute_force;
    options.profile = profile;
    return render_scene(scene_from_xml(mesh_scene), options);
}

ProfileCounts all_counts(const Profile &profile) {
    return profile_sums(profile, 0, profile.passes.size()).counts;
}

} // namespace

TEST_CASE("a profile does not change a bit of the picture, and its counts agree with the run's") {
    for (const int lanes : {1, 8, 16}) {
        INFO(lanes << " lanes");
        Profile profile;
        const RenderResult plain = render(nullptr, lanes);
        const RenderResult profiled = render(&profile, lanes);
        CHECK(profiled.image.f32 == plain.image.f32);
        CHECK(profiled.variance.f32 == plain.variance.f32);

        const ProfileCounts counts = all_counts(profile);
        CHECK(counts[PROFILE_CAMERA_RAYS] == 37 * 21 * spp);
        CHECK(total_rays(counts) == plain.stats.rays);
        CHECK(counts[PROFILE_PATH_RAYS] > counts[PROFILE_CAMERA_RAYS]);
        CHECK(counts[PROFILE_BOUNCES] <= counts[PROFILE_PATH_RAYS]);
        CHECK(counts[PROFILE_SHADOW_RAYS] <= counts[PROFILE_BOUNCES]);
        for (const double occupancy :
             {lane_occupancy(counts, lanes), shadow_occupancy(counts, lanes)}) {
            CHECK(occupancy > 0);
            CHECK(occupancy <= 1);
        }
        CHECK((lanes > 1 || lane_occupancy(counts, lanes) == 1));

        CHECK(path_nodes_per_ray(counts) > 0);
        CHECK(path_blocks_per_ray(counts) > 0);
        CHECK(shadow_nodes_per_ray(counts) > 0);
        CHECK(counts[PROFILE_PATH_SPHERE_BLOCKS] + counts[PROFILE_PACKET_SPHERE_BLOCKS] == 0);
        CHECK(counts[PROFILE_PACKET_RAYS] <= counts[PROFILE_CAMERA_RAYS]);
        CHECK(counts[PROFILE_PACKET_RAYS] <= lanes * counts[PROFILE_PACKETS]);
        // The scene's camera rays start together, tile by tile.
        CHECK((counts[PROFILE_PACKETS] > 0) == (lanes >= 8));
        CHECK((counts[PROFILE_PACKET_NODES] > 0) == (lanes >= 8));
        CHECK(tree_bytes(counts) > 0);
        CHECK(float_operations(counts, profile.config) > 0);
        CHECK(profile.peak.flops > 0);
        CHECK(profile.peak.bandwidth > 0);
    }
}

TEST_CASE("passes hold all samples in order, and commands follow one another within them") {
    Profile profile;
    render(&profile);
    int sample = 0;
    double camera_rays = 0;
    for (const ProfilePass &pass : profile.passes) {
        CHECK(pass.first_sample == sample);
        sample = pass.end_sample;
        camera_rays += pass.counts[PROFILE_CAMERA_RAYS];
        CHECK(pass.counts[PROFILE_CAMERA_RAYS] == 37 * 21 * (pass.end_sample - pass.first_sample));
    }
    CHECK(sample == spp);
    CHECK(camera_rays == 37 * 21 * spp);

    const ProfileSums all = profile_sums(profile, 0, profile.passes.size());
    double launches = 0, device_seconds = 0, gap_seconds = 0;
    for (std::size_t i = 0; i < profile.passes.size(); ++i) {
        const ProfileSums sums = profile_sums(profile, i, i + 1);
        CHECK(sums.launches > 0);
        launches += sums.launches;
        device_seconds += sums.device_seconds;
        gap_seconds += sums.gap_seconds;
    }
    CHECK(launches == all.launches);
    CHECK(device_seconds == Approx(all.device_seconds));
    CHECK(gap_seconds == Approx(all.gap_seconds).margin(1e-9));

    double ended = 0;
    for (const ProfileCommand &command : profile.commands) {
        CHECK(command.queued <= command.submitted);
        CHECK(command.submitted <= command.start);
        CHECK(command.start <= command.end);
        CHECK(ended <= command.start);
        ended = command.end;
    }
    for (const ProfilePhase &phase : profile.phases)
        CHECK(phase.start <= phase.end);
}

TEST_CASE("without the tree every ray visits every block and no node") {
    Profile profile;
    const RenderResult plain = render(nullptr, 0, true);
    const RenderResult profiled = render(&profile, 0, true);
    CHECK(profiled.image.f32 == plain.image.f32);
    const ProfileCounts counts = all_counts(profile);
    CHECK(tree_nodes(counts) == 0);
    const double blocks = path_blocks_per_ray(counts);
    CHECK(blocks > 0);
    CHECK(blocks == std::floor(blocks));
    // Shadow rays that a lane-wise primitive blocks do not ask the tree.
    CHECK(shadow_blocks_per_ray(counts) <= blocks);
}
