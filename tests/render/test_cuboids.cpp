/// Cubes that are tested as such and not as triangles: the same picture, and nothing shines
/// through.

#include "flatten/config_of.h"
#include "flatten/flat_scene.h"
#include "render_adapter.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

using namespace clrender;
using namespace clrender::test;

namespace {

std::string camera(const char *origin, const char *target) {
    return fmt::format(R"(<integrator type="path"><integer name="max_depth" value="6"/>
        <integer name="rr_depth" value="6"/></integrator>
        <sensor type="perspective"><transform name="to_world">
        <lookat origin="{}" target="{}" up="0 1 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="24"/>
        <rfilter type="box"/></film></sensor>)",
                       origin, target);
}

const std::string checkers = R"(<texture type="checkerboard" name="reflectance">
    <transform name="to_uv"><scale x="3" y="2"/></transform></texture>)";

/// Cubes on a ground under a lamp: turned, mirrored, and turned inside out.
const std::string cubes = R"(
    <shape type="rectangle"><transform name="to_world"><scale value="9"/>
        <rotate x="1" angle="-90"/></transform></shape>
    <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/>
        <translate y="5"/></transform>
        <emitter type="area"><rgb name="radiance" value="9"/></emitter></shape>
    <shape type="cube"><transform name="to_world"><scale x=".5" y="1" z=".7"/>
        <rotate x="1" angle="70"/><rotate z="1" angle="25"/><translate x="-2" y="1.4"/></transform>
        <bsdf type="diffuse">)" +
                          checkers + R"(</bsdf></shape>
    <shape type="cube"><transform name="to_world"><scale x="-.8" y=".5" z=".5"/>
        <rotate y="1" angle="20"/><translate y=".5"/></transform>
        <bsdf type="diffuse">)" +
                          checkers + R"(</bsdf></shape>
    <shape type="cube"><boolean name="flip_normals" value="true"/>
        <transform name="to_world"><scale value=".6"/><translate x="2" y=".6"/></transform>
        <bsdf type="twosided"><bsdf type="diffuse">)" +
                          checkers + R"(</bsdf></bsdf></shape>)";

/// A cube of no size to speak of that has edges aslant, so that rays walk a tree.
const std::string aslant = R"(<shape type="cube"><transform name="to_world">
    <matrix value="1e-3 5e-4 0 0 0 1e-3 0 -3 0 0 1e-3 0 0 0 0 1"/></transform></shape>)";

KernelConfig config(const Scene &scene) {
    return config_of(flatten(scene), {});
}

} // namespace

TEST_CASE("cubes are met where their triangles are, with the same coordinates") {
    const std::string seen = camera("0 3 7", "0 .7 0") + cubes;
    const Scene lane_wise = scene_from_xml(seen), tree = scene_from_xml(seen + aslant);
    REQUIRE(config(lane_wise).CUBOID_COUNT == 3);
    REQUIRE(config(lane_wise).HAS_TRIANGLES == 0);
    REQUIRE(config(tree).CUBOID_COUNT == 0);
    const Image a = render_measured(lane_wise, {.spp = 32}).mean;
    const Image b = render_measured(tree, {.spp = 32}).mean;
    // The same paths, but for those that rounding sends to the other side of an edge.
    REQUIRE(a.f32.size() == b.f32.size());
    std::size_t same = 0;
    for (std::size_t i = 0; i < a.f32.size(); ++i)
        same += std::abs(a.f32[i] - b.f32[i]) <= 1e-3F * b.f32[i] ? 1 : 0;
    CHECK(static_cast<double>(same) >= 0.97 * static_cast<double>(a.f32.size()));
    CHECK(channel_mean(a, 0) == Approx(channel_mean(b, 0)).epsilon(1e-3));
}

TEST_CASE("no light gets into a cube") {
    const Scene scene = scene_from_xml(camera(".1 .2 .3", "1 -.4 .2") + R"(
        <emitter type="constant"><rgb name="radiance" value="1000"/></emitter>
        <shape type="cube"><transform name="to_world"><scale x="2" y="1" z="1.5"/>
            <rotate y="1" angle="33"/><rotate x="1" angle="15"/></transform>
            <bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape>
        <shape type="cube"><transform name="to_world"><scale value=".2"/>
            <translate x=".9" y="-.3"/></transform></shape>)");
    REQUIRE(config(scene).CUBOID_COUNT == 2);
    const Image image = render_measured(scene, {.spp = 256}).mean;
    CHECK(std::all_of(image.f32.begin(), image.f32.end(), [](float v) { return v == 0; }));
}

TEST_CASE("cubes that are many, emit or let light through stay triangles") {
    const auto count = [](const std::string &shapes) {
        return config(scene_from_xml(shapes)).CUBOID_COUNT;
    };
    std::string many;
    for (int i = 0; i < 8; ++i)
        many += R"(<shape type="cube"/>)";
    CHECK(count(many) == 8);
    CHECK(count(many + R"(<shape type="cube"/>)") == 0);
    CHECK(count(R"(<shape type="cube"><bsdf type="dielectric"/></shape>)") == 0);
    CHECK(count(R"(<shape type="cube"><emitter type="area"/></shape>)") == 0);
}
