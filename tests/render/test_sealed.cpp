/// No light gets into a closed box: edges are tight, and the hit points of rays lie inside.

#include "render_adapter.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <functional>

#include <unistd.h>

using namespace clrender;
using namespace clrender::test;

namespace {

/// Where a box of half size 1 is put: turned, scaled, moved.
struct Place {
    double size, angle, x, y, z;
};
constexpr Place places[] = {{1, 0, 0, 0, 0},
                            {1, 31, 0, 0, 0},
                            {0.001, 17, 12.3, -4.56, 7.8},
                            {370, 77, 1e5, -2345.6, 33333.3}};

constexpr const char *surface = R"(<bsdf type="twosided"><bsdf type="diffuse">
    <rgb name="reflectance" value=".95"/></bsdf></bsdf>)";

std::string shape(const std::string &head, const std::string &first, const Place &p) {
    return fmt::format(R"(<shape {}<transform name="to_world">{}<rotate x=".8" y=".6" angle="{}"/>
        <scale value="{}"/><translate x="{}" y="{}" z="{}"/></transform>{}</shape>)",
                       head, first, p.angle, p.size, p.x, p.y, p.z, surface);
}

std::string rectangles(const Place &place) {
    std::string xml;
    for (const char *turn : {R"(y="1" angle="0")", R"(y="1" angle="90")", R"(y="1" angle="180")",
                             R"(y="1" angle="270")", R"(x="1" angle="90")", R"(x="1" angle="-90")"})
        xml += shape(R"(type="rectangle">)",
                     fmt::format(R"(<translate z="-1"/><rotate {}/>)", turn), place);
    return xml;
}

std::string cube(const Place &place) {
    return shape(R"(type="cube">)", "", place);
}

/// A cylinder with an elliptic profile between two lids, one sheared with both.
std::string can(const Place &place) {
    const std::string profile =
        R"(<scale x="1.2" y=".8"/><matrix value="1 0 .5 0  0 1 .3 0  0 0 1 0  0 0 0 1"/>)";
    std::string xml =
        shape(R"(type="cylinder">)", R"(<translate z="-.5"/><scale z="2"/>)" + profile, place);
    for (const char *lid : {R"(<translate z="1"/>)", R"(<translate z="-1"/>)"})
        xml += shape(R"(type="disk">)", lid + profile, place);
    return xml;
}

std::string egg(const Place &place) {
    return shape(R"(type="sphere">)", R"(<scale x="1.5" y=".9" z="1.1"/>)", place);
}

/// A mesh file's shape, flat-shaded.
std::string mesh(const std::string &text, const Place &place) {
    const auto file =
        std::filesystem::temp_directory_path() / fmt::format("clrender_sealed_{}.obj", getpid());
    std::ofstream(file) << text;
    return shape(fmt::format(R"(type="obj"><string name="filename" value="{}"/>
        <boolean name="face_normals" value="true"/>)",
                             file.string()),
                 "", place);
}

std::string tetrahedron(const Place &place) {
    return mesh("v 1.5 1.5 1.5\nv 1.5 -1.5 -1.5\nv -1.5 1.5 -1.5\nv -1.5 -1.5 1.5\n"
                "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n",
                place);
}

/// Two faces meet at five degrees.
std::string wedge(const Place &place) {
    const double half = 3 * std::tan(2.5 * M_PI / 180);
    return mesh(fmt::format("v -1.5 0 -2\nv -1.5 0 2\nv 1.5 {0} -2\nv 1.5 {0} 2\nv 1.5 -{0} -2\n"
                            "v 1.5 -{0} 2\nf 1 2 4\nf 1 4 3\nf 1 5 6\nf 1 6 2\nf 3 4 6\n"
                            "f 3 6 5\nf 1 3 5\nf 2 6 4\n",
                            half),
                place);
}

/// A sphere of 24 x 12 faces.
std::string closed_mesh(const Place &place) {
    constexpr int around = 24, down = 12;
    std::string text = "v 0 0 1\n";
    for (int i = 1; i < down; ++i)
        for (int j = 0; j < around; ++j) {
            const double a = M_PI * i / down, b = 2 * M_PI * j / around;
            text += fmt::format("v {:.9g} {:.9g} {:.9g}\n", std::sin(a) * std::cos(b),
                                std::sin(a) * std::sin(b), std::cos(a));
        }
    text += "v 0 0 -1\n";
    const auto at = [](int i, int j) { return 2 + (i - 1) * around + j % around; };
    const int last = 2 + (down - 1) * around;
    for (int j = 0; j < around; ++j) {
        text += fmt::format("f 1 {} {}\nf {} {} {}\n", at(1, j), at(1, j + 1), last,
                            at(down - 1, j + 1), at(down - 1, j));
        for (int i = 1; i < down - 1; ++i)
            text += fmt::format("f {} {} {} {}\n", at(i, j), at(i + 1, j), at(i + 1, j + 1),
                                at(i, j + 1));
    }
    return mesh(text, place);
}

/// An instance of `group`, turned first, then put in its place; `flip` is the sign of a scale.
std::string instance(const char *group, const char *first, const Place &p, int flip) {
    return fmt::format(R"(<shape type="instance"><ref id="{}"/><transform name="to_world">{}
        <rotate x=".8" y=".6" angle="{}"/><scale x="{}" y="{}" z="{}"/>
        <translate x="{}" y="{}" z="{}"/></transform></shape>)",
                       group, first, p.angle, p.size, flip * p.size, p.size, p.x, p.y, p.z);
}

/// A cube that is one instance, mirrored.
std::string cube_instance(const Place &place) {
    return fmt::format(
               R"(<shape type="shapegroup" id="cube"><shape type="cube">{}</shape></shape>)",
               surface) +
           instance("cube", "", place, -1);
}

/// Six walls, an instance each.
std::string wall_instances(const Place &place) {
    std::string xml = fmt::format(
        R"(<shape type="shapegroup" id="wall"><shape type="rectangle">{}</shape></shape>)",
        surface);
    for (const char *turn : {R"(y="1" angle="0")", R"(y="1" angle="90")", R"(y="1" angle="180")",
                             R"(y="1" angle="270")", R"(x="1" angle="90")", R"(x="1" angle="-90")"})
        xml += instance("wall", fmt::format(R"(<translate z="-1"/><rotate {}/>)", turn).c_str(),
                        place, 1);
    return xml;
}

/// Pixels that are not black, of a picture taken inside under a bright sky.
int lit_pixels(const std::string &box, const Place &p) {
    const bool full = std::getenv("CLRENDER_STRESS") != nullptr;
    const int side = full ? 192 : 48;
    const std::string xml = fmt::format(
        R"(<integrator type="path"><integer name="max_depth" value="100"/>
        <integer name="rr_depth" value="1000"/></integrator>
        <sensor type="perspective"><float name="fov" value="100"/><transform name="to_world">
        <lookat origin="{0} {1} {2}" target="{3} {4} {5}" up="0 1 0"/></transform>
        <film type="hdrfilm"><rfilter type="box"/><integer name="width" value="{6}"/>
        <integer name="height" value="{6}"/></film></sensor>
        <emitter type="constant"><rgb name="radiance" value="1e5"/></emitter>{7})",
        p.x, p.y, p.z, p.x - p.size, p.y - 0.6 * p.size, p.z - 0.4 * p.size, side, box);
    const Image image = render_measured(scene_from_xml(xml), {.spp = full ? 272 : 16}).mean;
    int lit = 0;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            lit += value_at(image, x, y) == 0 ? 0 : 1;
    return lit;
}

} // namespace

TEST_CASE("sealed boxes stay black inside under a bright sky") {
    struct Box {
        const char *name;
        std::string (*make)(const Place &);
    };
    for (const Box &box :
         {Box{"rectangles", rectangles}, Box{"cube", cube}, Box{"tetrahedron", tetrahedron},
          Box{"wedge", wedge}, Box{"closed mesh", closed_mesh}, Box{"can", can}, Box{"egg", egg}})
        for (const Place &place : places) {
            INFO(box.name << " of size " << place.size << ", turned by " << place.angle);
            CHECK(lit_pixels(box.make(place), place) == 0);
        }
}

TEST_CASE("sealed boxes of instances stay black inside under a bright sky") {
    for (const Place &place : places) {
        INFO("size " << place.size << ", turned by " << place.angle);
        CHECK(lit_pixels(cube_instance(place), place) == 0);
        CHECK(lit_pixels(wall_instances(place), place) == 0);
    }
}
