/// One thing that is far away or huge costs nothing near it any precision: a scene of objects of
/// .02 to 3 units keeps its picture under a far sun, on a planet, before a far wall, on a ground of
/// huge triangles, and seen by a camera that is far away.

#include "render_adapter.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/format.h>
#include <fstream>

#include <filesystem>
#include <unistd.h>

using namespace clrender;
using namespace clrender::test;

namespace {

constexpr int side = 8; ///< of the blocks that are compared, pixels

std::string camera(double distance = 4) {
    // A view of the same width at the same slope, from any distance.
    const double slope = 0.25, half_width = 1.5;
    const double way = distance * std::hypot(1, slope);
    return fmt::format(
        R"(<sensor type="perspective"><float name="fov" value="{:.17g}"/>
        <transform name="to_world"><lookat origin="0 {:.17g} {:.17g}" target="0 .2 0" up="0 1 0"/>
        </transform><film type="hdrfilm"><integer name="width" value="64"/>
        <integer name="height" value="48"/><rfilter type="box"/></film></sensor>)",
        2 * std::atan(half_width / way) * 180 / M_PI, 0.2 + slope * distance, distance);
}

std::string ball(double x, double y, double z, double radius) {
    return fmt::format(R"(<shape type="sphere"><point name="center" x="{:.17g}" y="{:.17g}"
        z="{:.17g}"/><float name="radius" value="{:.17g}"/></shape>)",
                       x, y, z, radius);
}

/// Balls and cubes that stand on y = 0, from .02 units on.
std::string objects() {
    std::string xml;
    const double radii[] = {0.25, 0.1, 0.04, 0.02};
    for (int i = 0; i < 8; ++i) {
        const double r = radii[i % 4];
        xml += ball(-1.1 + 0.31 * i, r, 0.8 * std::sin(2.1 * i), r);
        xml += fmt::format(R"(<shape type="cube"><transform name="to_world"><scale value="{0}"/>
            <rotate y="1" angle="{1}"/><translate value="{2} {0} {3}"/></transform></shape>)",
                           r / 2, 17 * i, 1.1 - 0.29 * i, 0.9 * std::sin(1.3 * i + 2));
    }
    return xml;
}

std::string floor_below() {
    return R"(<shape type="rectangle"><transform name="to_world"><scale value="3"/>
        <rotate x="1" angle="-90"/></transform></shape>)";
}

/// A sun of half a degree, of one brightness whatever its distance.
std::string sun(double distance) {
    const double axis = distance / std::sqrt(0.99);
    return fmt::format(R"(<shape type="sphere"><point name="center" x="{0}" y="{1}" z="{0}"/>
        <float name="radius" value="{2}"/><emitter type="area"><rgb name="radiance" value="3000"/>
        </emitter></shape>)",
                       0.5 * axis, 0.7 * axis, 0.01 * distance);
}

std::string planet(double radius) {
    return ball(0, -radius, 0, radius);
}

/// Two triangles, as a mesh file whose name is returned as a shape.
std::string quad(const std::string &corners) {
    const auto file =
        std::filesystem::temp_directory_path() / fmt::format("clrender_far_{}.obj", getpid());
    std::ofstream(file) << corners << "f 1 2 3 4\n";
    return fmt::format(R"(<shape type="obj"><string name="filename" value="{}"/></shape>)",
                       file.string());
}

std::string wall(double distance) {
    return quad(fmt::format("v {1} {1} {1}\nv {0} {1} {1}\nv {0} {0} {1}\nv {1} {0} {1}\n",
                            distance, -distance));
}

/// Just below the objects; its corners do not lie symmetrically.
std::string ground(double size) {
    return quad(fmt::format("v {} 0 {}\nv {} 0 {}\nv {} 0 {}\nv {} 0 {}\n", -size, 1.3 * size,
                            0.9 * size, size, 1.1 * size, -size, -size, -0.7 * size));
}

std::string square_light(double distance) {
    return fmt::format(R"(<shape type="rectangle"><transform name="to_world"><scale value="{2}"/>
        <lookat origin="{0} {1} {0}" target="0 0 0" up="0 1 0"/></transform>
        <emitter type="area"><rgb name="radiance" value="1000"/></emitter></shape>)",
                       0.5 * distance, 0.7 * distance, 0.02 * distance);
}

std::string cube_light(double distance) {
    return fmt::format(R"(<shape type="cube"><transform name="to_world"><scale value="{2}"/>
        <lookat origin="{0} {1} {0}" target="0 0 0" up="0 1 0"/></transform>
        <emitter type="area"><rgb name="radiance" value="500"/></emitter></shape>)",
                       0.5 * distance, 0.7 * distance, 0.02 * distance);
}

std::string point_light(double distance) {
    return fmt::format(R"(<emitter type="point"><point name="position" x="{0}" y="{1}" z="{0}"/>
        <rgb name="intensity" value="{2}"/></emitter>)",
                       0.5 * distance, 0.7 * distance, 2 * distance * distance);
}

Image picture(const std::string &sensor, const std::string &shapes, bool double_precision = false) {
    const std::string xml =
        R"(<integrator type="path"><integer name="max_depth" value="3"/></integrator>)" + sensor +
        R"(<emitter type="constant"><rgb name="radiance" value=".5"/></emitter>)" + shapes;
    return render_measured(scene_from_xml(xml), {.spp = 16, .double_precision = double_precision})
        .mean;
}

/// How many blocks differ by more than a tenth in some channel; one that is not a number does.
int blocks_off(const Image &a, const Image &b) {
    int off = 0;
    for (int y = 0; y < a.height; y += side)
        for (int x = 0; x < a.width; x += side)
            for (int c = 0; c < a.channels; ++c) {
                double sum_a = 0, sum_b = 0;
                for (int j = 0; j < side; ++j)
                    for (int i = 0; i < side; ++i) {
                        sum_a += value_at(a, x + i, y + j, c);
                        sum_b += value_at(b, x + i, y + j, c);
                    }
                if (!(std::abs(sum_a - sum_b) <= 0.1 * std::abs(sum_b))) {
                    ++off;
                    break;
                }
            }
    return off;
}

} // namespace

TEST_CASE("far: lights and walls from 10^4 to 10^8 units away change no block of the picture") {
    using Thing = std::string (*)(double);
    struct Case {
        const char *name;
        Thing thing;
    };
    for (const Case &c :
         {Case{"sun", sun}, Case{"wall", wall}, Case{"rectangle light", square_light},
          Case{"cube light", cube_light}, Case{"point light", point_light}}) {
        const std::string near = floor_below() + objects();
        const Image reference = picture(camera(), near + c.thing(1e4));
        for (const double distance : {1e6, 1e8}) {
            INFO(c.name << " at " << distance);
            CHECK(blocks_off(picture(camera(), near + c.thing(distance)), reference) == 0);
        }
    }
}

TEST_CASE("far: on planets and grounds of 10^4 to 10^8 units the picture is that of double "
          "precision") {
    for (const double radius : {1e4, 6.4e6, 1e8}) {
        INFO("planet of radius " << radius);
        const std::string shapes = objects() + sun(1000) + planet(radius);
        CHECK(blocks_off(picture(camera(), shapes), picture(camera(), shapes, true)) == 0);
    }
    for (const double size : {1e4, 1e6, 1e8}) {
        INFO("ground of size " << size);
        const std::string shapes = objects() + sun(1000) + ground(size);
        CHECK(blocks_off(picture(camera(), shapes), picture(camera(), shapes, true)) == 0);
    }
}

TEST_CASE("far: a camera with a narrow angle sees the same from 10^4 to 10^8 units away, beside a "
          "planet too") {
    for (const std::string &under : {floor_below(), planet(1e8)}) {
        const std::string shapes = under + objects() + sun(1000);
        const Image reference = picture(camera(1e4), shapes);
        for (const double distance : {1e6, 1e8}) {
            INFO("camera at " << distance << " above " << under);
            CHECK(blocks_off(picture(camera(distance), shapes), reference) == 0);
        }
    }
}
