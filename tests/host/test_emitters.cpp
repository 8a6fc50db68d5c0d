/// Lights without a surface and cameras without perspective: what the reader makes of them, and
/// where they lie in the flat scene. The expected numbers are those of Mitsuba 3.9.1.

#include "flatten/flat_scene.h"
#include "mitsuba_text_scene.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace clrender;
using namespace test;

namespace {

Emitter emitter(const std::string &type, const std::string &content) {
    return load_text("<emitter type=\"" + type + "\">" + content + "</emitter>").emitters.at(0);
}

/// A scene with a ball in the middle, whose unit is the scene's.
FlatScene flat(const std::string &content) {
    return flatten(load_text(R"(<shape type="sphere"/>)" + content));
}

std::string spot(const std::string &content) {
    return "<emitter type=\"spot\">" + content + "</emitter>";
}

} // namespace

TEST_CASE("spots", "[emitters]") {
    const Emitter plain = emitter("spot", "");
    CHECK(plain.kind == EmitterKind::spot);
    CHECK(plain.intensity == Rgb(1));
    CHECK(plain.cutoff_angle == 20);
    CHECK(plain.beam_width == 15);
    CHECK(plain.radiance == none);
    const Emitter narrow = emitter("spot", R"(<float name="cutoff_angle" value="8"/>)");
    CHECK(narrow.beam_width == 6);
    const Emitter hard = emitter("spot", R"(<float name="cutoff_angle" value="8"/>
                                            <float name="beam_width" value="9"/>)");
    CHECK(hard.beam_width == 8);

    const FlatScene scene = flat(spot(""));
    REQUIRE(scene.light_beams.size() == 1);
    const LightBeam &beam = scene.light_beams[0];
    CHECK(beam.cutoff == Approx(20. / 360));
    CHECK(beam.ramp == Approx(72));
    CHECK(beam.reach == 1);
    CHECK(beam.axis[2] == 1);
    CHECK(
        std::isfinite(flat(spot(R"(<float name="beam_width" value="20"/>)")).light_beams[0].ramp));
    CHECK(flat(spot(R"(<rgb name="intensity" value="0"/>)")).lights.empty());
}

TEST_CASE("the texture of a spot covers the square around its cone", "[emitters]") {
    const FlatScene scene = flat(spot(R"(<texture name="texture" type="checkerboard"/>
        <float name="cutoff_angle" value="45"/>
        <transform name="to_world"><scale x="2" y="4" z="2"/></transform>)"));
    const LightBeam &beam = scene.light_beams.at(0);
    CHECK(beam.to_u[0] == Approx(0.25));
    CHECK(beam.to_v[1] == Approx(0.125));
    CHECK(beam.axis[2] == Approx(0.5));
    CHECK(beam.reach == Approx(2));
    CHECK(scene.lights.at(0).texture == 0);
}

TEST_CASE("directional lights", "[emitters]") {
    const std::string vector = R"(<vector name="direction" x="0" y="-3" z="4"/>)";
    CHECK(emitter("directional", "").direction == glm::dvec3(0, 0, 1));
    CHECK(emitter("directional", vector).direction == glm::dvec3(0, -0.6, 0.8));
    CHECK(emitter("directional", R"(<transform name="to_world"><scale value="7"/>
                                    <rotate y="1" angle="90"/></transform>)")
              .direction.x == Approx(1));
    const FlatScene scene =
        flat("<emitter type=\"directional\">" + vector + "</emitter><emitter type=\"point\"/>");
    REQUIRE(scene.lights.size() == 2);
    CHECK(scene.lights[0].position[1] == Approx(0.6));
    CHECK(scene.lights[0].radiance[0] == 1);
    // Each lies below the root, and only the distant one is marked.
    REQUIRE(scene.light_nodes.size() == 1);
    CHECK(scene.light_nodes[0].bounds[0].child == (CLR_LIGHT_LEAF | 1));
    CHECK(scene.light_nodes[0].bounds[1].child == (CLR_LIGHT_LEAF | CLR_LIGHT_DISTANT));
    CHECK(scene.frame.shadow_free_distance == 0);
}

TEST_CASE("projectors", "[emitters]") {
    const Emitter plain = emitter("projector", R"(<rgb name="irradiance" value="2"/>)");
    CHECK(plain.fov_axis == FovAxis::diagonal);
    CHECK(plain.fov == Approx(46.7930));
    const FlatScene scene = flat(R"(<emitter type="projector"><rgb name="irradiance" value="2"/>
        <float name="fov" value="90"/><float name="scale" value="3"/>
        <transform name="to_world"><scale value="2"/></transform></emitter>)");
    const LightBeam &beam = scene.light_beams.at(0);
    CHECK(beam.to_u[0] == Approx(-0.25));
    CHECK(beam.to_v[1] == Approx(-0.25));
    CHECK(beam.front[2] == Approx(2));
    const double unit = scene.placement.scale;
    CHECK(scene.lights.at(0).radiance[0] == Approx(6 * std::numbers::pi * unit * unit));
}

TEST_CASE("a directional area light is black", "[emitters]") {
    const Scene scene = load_text(R"(<shape type="disk"><emitter type="directionalarea">
        <rgb name="radiance" value="5"/></emitter></shape>)");
    REQUIRE(scene.emitters.size() == 1);
    CHECK(scene.shapes.at(0).emitter == 0);
    CHECK(scene.textures.at(static_cast<std::size_t>(scene.emitters[0].radiance)).value == Rgb(0));
    CHECK(flatten(scene).lights.empty());
}

TEST_CASE("wrong lights are refused with their place", "[emitters]") {
    const auto error = [](const std::string &type, const std::string &content) {
        return error_of_text("<emitter type=\"" + type + "\">" + content + "</emitter>");
    };
    const std::string wide = R"(<float name="cutoff_angle" value="95"/>)";
    const std::string board = R"(<texture name="texture" type="checkerboard"/>)";
    CHECK(error("spot", wide).empty());
    CHECK(error("spot", wide + board).find("2: ") == 0);
    CHECK(error("spot", R"(<rgb name="texture" value="1"/>)").find("plain colour") !=
          std::string::npos);
    CHECK(error("directional", R"(<vector name="direction" x="0" y="0" z="0"/>)")
              .find("has no length") != std::string::npos);
    CHECK(error("projector", "").find("no \"irradiance\"") != std::string::npos);
    CHECK(error("collimated", "").find("small cutoff_angle") != std::string::npos);
    CHECK(error("timed_sunsky", "").find("\"sunsky\" for one moment") != std::string::npos);
    CHECK(error_of_text(R"(<shape type="sphere"><emitter type="spot"/></shape>)")
              .find("inside of a shape") != std::string::npos);
}

TEST_CASE("an orthographic picture is as wide as its matrix says", "[emitters]") {
    const std::string camera = R"(<sensor type="orthographic"><transform name="to_world">
        <scale x="3" y="5" z="2"/><translate z="-8"/></transform>
        <film type="hdrfilm"><integer name="width" value="40"/>
        <integer name="height" value="20"/></film>)";
    const FlatScene scene = flat(camera + "</sensor>");
    const FrameData &f = scene.frame;
    const double unit = scene.placement.scale;
    CHECK(f.corner[2] == 1);
    CHECK(f.step_x[0] == 0);
    CHECK(f.start_x[0] == Approx(-6. / 40 * unit));
    CHECK(f.start_y[1] == Approx(-10. / 40 * unit));
    CHECK(f.start[0] == Approx(3 * unit));
    CHECK(f.start[1] == Approx(2.5 * unit));
    // The near plane is scaled with the camera, the distance from there to the far one is not.
    const FrameData clipped =
        flat(camera + R"(<float name="near_clip" value="1"/><float name="far_clip" value="9"/>
                         </sensor>)")
            .frame;
    CHECK(clipped.far_clip - clipped.near_clip + clipped.skipped_depth == Approx(8 * unit));
}

TEST_CASE("a ball beside the film's plane counts as around the camera", "[emitters]") {
    const auto opaque = [](const std::string &place) {
        return flat(R"(<sensor type="orthographic"><transform name="to_world">)" + place +
                    "</transform></sensor>")
            .facts.opaque_count;
    };
    CHECK(opaque(R"(<translate z="-1.5"/>)") == 1);
    CHECK(opaque(R"(<translate z="-.5" x="9"/>)") == 0);
}

TEST_CASE("one of several sensors is chosen", "[emitters]") {
    const ScratchFolder folder;
    const std::string path = folder.file("s.xml", R"(<scene version="3.0.0"><shape type="sphere"/>
        <sensor type="perspective"><float name="fov" value="10"/></sensor>
        <sensor type="perspective"><float name="fov" value="20"/></sensor>
        <sensor type="irradiancemeter"/></scene>)");
    const auto fov = [&](std::optional<int> sensor) {
        return load_scene(path, {.defines = {}, .sensor = sensor}).sensor.fov;
    };
    CHECK(fov({}) == 10);
    CHECK(fov(0) == 10);
    CHECK(fov(1) == 20);
    CHECK(error_of([&] { fov(2); }).find("is not supported, the nearest") != std::string::npos);
    CHECK(error_of([&] { fov(3); }).find("3 sensors, expected --sensor from 0 to 2") !=
          std::string::npos);
}
