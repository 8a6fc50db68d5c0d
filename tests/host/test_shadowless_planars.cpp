#include "flatten/shadowless_planars.h"

#include "mitsuba_text_scene.h"

#include <catch2/catch.hpp>

#include <fmt/core.h>

using namespace clrender;

namespace {

/// A room of edge length 2 around the origin, turned as a whole: floor, ceiling, and four walls.
std::string room(const std::string &turn) {
    std::string text;
    for (const char *place :
         {R"(<rotate x="1" angle="-90"/><translate y="-1"/>)",
          R"(<rotate x="1" angle="90"/><translate y="1"/>)", R"(<translate z="-1"/>)",
          R"(<rotate y="1" angle="180"/><translate z="1"/>)",
          R"(<rotate y="1" angle="90"/><translate x="-1"/>)",
          R"(<rotate y="1" angle="-90"/><translate x="1"/>)"})
        text += fmt::format(
            R"(<shape type="rectangle"><transform name="to_world">{}{}</transform></shape>)", place,
            turn);
    return text;
}

std::string lamp(const std::string &kind, const std::string &place) {
    return fmt::format(R"(<shape type="{}"><transform name="to_world">{}</transform>
                          <emitter type="area"/></shape>)",
                       kind, place);
}

std::string ball(double x, double radius) {
    return fmt::format(R"(<shape type="sphere"><point name="center" x="{}" y="0" z="0"/>
                          <float name="radius" value="{}"/></shape>)",
                       x, radius);
}

constexpr double touching = 1e-7;

std::vector<bool> of(const std::string &content) {
    const Scene scene = test::load_text(content);
    const ShadowlessPlanars planars(scene, touching);
    std::vector<bool> contained;
    for (std::size_t i = 0; i < scene.shapes.size(); ++i)
        contained.push_back(planars.contains(i));
    return contained;
}

/// The six walls of room(), of which those in `casting` cast shadows, and what follows.
std::vector<bool> walls(const std::vector<std::size_t> &casting, const std::vector<bool> &rest) {
    std::vector<bool> all(6, true);
    for (const std::size_t i : casting)
        all[i] = false;
    all.insert(all.end(), rest.begin(), rest.end());
    return all;
}

} // namespace

TEST_CASE("the walls of a room and its only light cast no shadows", "[shadowless]") {
    for (const std::string turn : {"", R"(<rotate x="1" y="2" z="3" angle="40"/><scale value="9"/>
                                          <translate x="70" y="-20" z="5"/>)"}) {
        const std::string light =
            lamp("rectangle",
                 R"(<scale value=".2"/><rotate x="1" angle="90"/><translate y=".9"/>)" + turn);
        CHECK(of(room(turn) + light) == walls({}, {true}));
        const std::string cube = fmt::format(
            R"(<shape type="cube"><transform name="to_world"><scale value=".4"/>
               <translate y="-.6"/>{}</transform></shape>)",
            turn);
        CHECK(of(room(turn) + light + cube) == walls({}, {true, false}));
    }
}

TEST_CASE("a wall that something reaches through casts shadows", "[shadowless]") {
    const std::string light = lamp("sphere", R"(<scale value=".1"/>)");
    CHECK(of(room("") + light + ball(0.5, 0.5)) == walls({}, {false, false}));
    CHECK(of(room("") + light + ball(0.5, 0.5000002)) == walls({5}, {false, false}));
    CHECK(of(room("") + light + ball(-0.75, 0.3)) == walls({4}, {false, false}));
    // Only a corner of the cube is outside.
    const std::string cube = R"(<shape type="cube"><transform name="to_world"><scale value=".3"/>
        <rotate z="1" angle="45"/><translate x=".6"/></transform></shape>)";
    CHECK(of(room("") + light + cube) == walls({5}, {false, false}));
    // Beyond the plane of a wall, although far from its rectangle.
    CHECK(of(room("") + light + lamp("disk", R"(<translate x="50" z="50" y="0"/>)")) ==
          walls({3, 5}, {false, true}));
}

TEST_CASE("light close behind a wall is behind it, however large or far off the wall is",
          "[shadowless]") {
    const std::string far = R"(<translate x="4000000" z="-500000"/>)";
    for (const double outside : {1e-6, 1e-3, 0.5}) {
        const auto lamp_at = [&](const std::string &place) {
            return lamp("sphere",
                        fmt::format(R"(<scale value=".1"/><translate x="{}"/>)", 0.9 + outside) +
                            place);
        };
        CHECK(of(room("") + lamp_at("")) == walls({5}, {false}));
        CHECK(of(room(far) + lamp_at(far)) == walls({5}, {false}));
        const std::string ground = R"(<shape type="{}"><transform name="to_world">
            <scale value="1000000"/><rotate x="1" angle="-90"/></transform></shape>)";
        const std::string above = R"(<shape type="sphere"><transform name="to_world">
            <translate y="1"/></transform></shape>)";
        for (const char *kind : {"rectangle", "disk"})
            CHECK(of(fmt::format(fmt::runtime(ground), kind) + above +
                     lamp("sphere", fmt::format(R"(<scale value=".1"/><translate y="{}"/>)",
                                                -0.1 - outside))) ==
                  std::vector<bool>{false, false, false});
    }
    CHECK(of(room(far) + lamp("sphere", R"(<scale value=".1"/>)" + far)) == walls({}, {false}));
}

TEST_CASE("a wall between rooms, and walls with light outside, cast shadows", "[shadowless]") {
    const std::string point = R"(<emitter type="point"><point name="position" x="{}" y="0" z="0"/>
                                 </emitter>)";
    const auto light_at = [&](double x) { return fmt::format(fmt::runtime(point), x); };
    CHECK(of(room("") + light_at(0.9)) == walls({}, {}));
    CHECK(of(room("") + light_at(1.1)) == walls({5}, {}));
    CHECK(of(room("") + light_at(0) + room(R"(<translate x="2"/>)")) ==
          std::vector<bool>{true, true, true, true, true, false, //
                            true, true, true, true, false, true});
    CHECK(of(room("") + R"(<emitter type="constant"/>)") == walls({}, {}));
    for (const char *kind : {"spot", "projector"})
        for (const double x : {0.9, 1.1})
            CHECK(of(room("") + fmt::format(R"(<emitter type="{}"><rgb name="{}" value="1"/>
                                    <transform name="to_world"><translate x="{}"/></transform>
                                    </emitter>)",
                                            kind, kind[0] == 's' ? "intensity" : "irradiance",
                                            x)) == (x < 1 ? walls({}, {}) : walls({5}, {})));
}

TEST_CASE("light from one direction has to pass every wall", "[shadowless]") {
    CHECK(of(room("") + R"(<emitter type="directional"/>)") == std::vector<bool>(6, false));
}

TEST_CASE("of several lights each may be in the way of another", "[shadowless]") {
    const std::string first = lamp("rectangle", R"(<scale value=".2"/><translate z=".5"/>)");
    const std::string second = lamp("disk", R"(<scale value=".2"/><translate z="-.5"/>)");
    CHECK(of(room("") + first) == walls({}, {true}));
    CHECK(of(room("") + second) == walls({}, {true}));
    CHECK(of(room("") + first + second) == walls({}, {false, false}));
    CHECK(of(room("") + first + R"(<emitter type="constant"/>)") == walls({}, {true}));
    CHECK(of(room("") + first + R"(<emitter type="point"/>)") == walls({}, {false}));
}

TEST_CASE("where a map is sampled every wall casts shadows", "[shadowless]") {
    const test::ScratchFolder folder;
    const std::string map =
        folder.file("map.pfm", "PF\n4 4\n-1\n" + std::string(std::size_t{4} * 4 * 12, '\0'));
    const std::string sky = fmt::format(
        R"(<emitter type="envmap"><string name="filename" value="{}"/></emitter>)", map);
    CHECK(of(room("") + sky) == std::vector<bool>(6, false));
}
