/// Closed-form light transport: each test derives the radiance of every pixel and compares.

#include "render_adapter.h"
#include "selftest/check.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

using namespace clrender;
using namespace clrender::test;
using glm::dvec3;

namespace {

constexpr double pi = std::numbers::pi;
constexpr int size = 16;

std::string integrator(int max_depth, int rr_depth = 1000) {
    return fmt::format(R"(<integrator type="path"><integer name="max_depth" value="{}"/>
        <integer name="rr_depth" value="{}"/></integrator>)",
                       max_depth, rr_depth);
}

/// A camera with a square film of size^2 pixels and the box filter.
std::string camera(const std::string &origin, const std::string &target, const std::string &up,
                   double fov = 40) {
    return fmt::format(R"(<sensor type="perspective"><float name="fov" value="{}"/>
        <transform name="to_world"><lookat origin="{}" target="{}" up="{}"/></transform>
        <film type="hdrfilm"><integer name="width" value="{}"/><integer name="height" value="{}"/>
        <rfilter type="box"/></film></sensor>)",
                       fov, origin, target, up, size, size);
}

/// Looks from (0, 5, 0) straight down; +x is at the left of the picture and +z at its top.
const std::string camera_above = camera("0 5 0", "0 0 0", "0 0 1");

/// A floor at y = 0 of albedo .6.
const std::string floor_below = R"(<shape type="rectangle"><transform name="to_world">
    <scale value="20"/><rotate x="1" angle="-90"/></transform>
    <bsdf type="diffuse"><rgb name="reflectance" value=".6"/></bsdf></shape>)";
constexpr double albedo = 0.6;

/// Tangents of the angles between the axis and the ray through a pixel's centre.
double slope(int pixel, double fov = 40) {
    return (2 * (pixel + 0.5) / size - 1) * std::tan(fov * pi / 360);
}

/// Where camera_above sees the floor at the centre of a pixel.
dvec3 floor_point(int x, int y) {
    return {-5 * slope(x), 0, -5 * slope(y)};
}

/// A grey picture without noise.
MeasuredImage exact_picture(const std::function<double(int, int)> &radiance) {
    MeasuredImage exact;
    exact.mean.width = exact.mean.height = size;
    exact.mean.channels = 3;
    exact.variance = exact.mean;
    exact.variance.f32.assign(size * size * 3, 0);
    exact.mean_se.assign(3, 0);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            exact.mean.f32.insert(exact.mean.f32.end(), 3, static_cast<float>(radiance(x, y)));
    return exact;
}

/// Renders at pixel centres and compares with the closed form by z-test.
void check_closed_form(const std::string &name, const std::string &xml, int spp,
                       const std::function<double(int, int)> &radiance) {
    const auto picture = render_measured(scene_from_xml(xml), {.spp = spp, .pixel_centers = true});
    const auto verdict = compare_or_save(name, picture, exact_picture(radiance));
    INFO(verdict.summary);
    CHECK(verdict.passes);
}

/// Every pixel has this value, to a relative error of `tolerance`.
void check_constant(const Image &image, double value, double tolerance) {
    selftest::Worst worst;
    for (const float pixel : image.f32)
        worst.see(std::abs(double{pixel} / value - 1));
    INFO("expected " << value);
    CHECK(worst.value() <= tolerance);
}

double fresnel(double cos_i, double eta) {
    const double cos_t = std::sqrt(1 - (1 - cos_i * cos_i) / (eta * eta));
    const double s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    const double p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return (s * s + p * p) / 2;
}

} // namespace

TEST_CASE("furnace: a closed room of albedo a that emits 1 has the radiance 1/(1-a)") {
    const std::string room = GENERATE(as<std::string>{}, "sphere", "cube");
    const double a = GENERATE(0.5, 0.8, 0.95);
    // No roulette before the path's weight is .01: it would only add noise.
    const int rr_depth = static_cast<int>(std::ceil(std::log(0.01) / std::log(a)));
    const Scene scene =
        scene_from_xml(integrator(-1, rr_depth) + camera(".1 .2 -.3", "0 0 1", "0 1 0", 60) +
                       fmt::format(R"(<shape type="{}"><boolean name="flip_normals" value="true"/>
            <bsdf type="diffuse"><rgb name="reflectance" value="{}"/></bsdf>
            <emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>)",
                                   room, a));
    const auto picture = render_measured(scene, {.spp = room == "sphere" ? 512 : 2048});
    INFO(room << ", albedo " << a);
    for (int c = 0; c < 3; ++c)
        CHECK(channel_mean(picture.mean, c) == Approx(1 / (1 - a)).epsilon(1e-3));
}

TEST_CASE("a point light gives rho/pi I cos/d^2 at the centres of the pixels") {
    const dvec3 light{1, 2, 0.5};
    const auto picture = render_measured(
        scene_from_xml(integrator(2) + camera_above + floor_below +
                       R"(<emitter type="point"><point name="position" x="1" y="2" z=".5"/>
            <rgb name="intensity" value="10"/></emitter>)"),
        {.spp = 4, .pixel_centers = true});
    selftest::Worst worst;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const dvec3 to_light = light - floor_point(x, y);
            const double d = glm::length(to_light);
            const double expected = albedo / pi * 10 * (to_light.y / d) / (d * d);
            worst.see(std::abs(value_at(picture.mean, x, y) / expected - 1));
        }
    CHECK(worst.value() <= 1e-5);
}

// A sphere of radius r that is wholly above the horizon gives the irradiance pi L (r/d)^2 cos.
TEST_CASE("a spherical light has the form factor (r/d)^2 cos") {
    const dvec3 centre{1, 2, 0.5};
    const double radius = GENERATE(0.01, 0.5);
    check_closed_form(
        "sphere_light",
        integrator(2) + camera_above + floor_below +
            fmt::format(R"(<shape type="sphere"><point name="center" x="1" y="2" z=".5"/>
            <float name="radius" value="{}"/>
            <emitter type="area"><rgb name="radiance" value="7"/></emitter></shape>)",
                        radius),
        2048, [&](int x, int y) {
            const dvec3 view = floor_point(x, y) - dvec3{0, 5, 0};
            const dvec3 to_centre = centre - dvec3{0, 5, 0};
            const double along = glm::dot(to_centre, glm::normalize(view));
            if (glm::dot(to_centre, to_centre) - along * along < radius * radius)
                return 7.; // the light itself is in view
            const dvec3 to_light = centre - floor_point(x, y);
            const double d2 = glm::dot(to_light, to_light);
            return albedo * 7 * radius * radius / d2 * to_light.y / std::sqrt(d2);
        });
}

// Lambert's formula: the irradiance of a polygon of radiance L is L/2 times the sum over its edges
// of the angle the edge subtends times the normal of the plane through edge and receiver.
TEST_CASE("a rectangular light has Lambert's polygon form factor") {
    const std::array<dvec3, 4> corners{dvec3{0.4, 6, -0.9}, dvec3{1.6, 6, -0.9}, dvec3{1.6, 6, 1.1},
                                       dvec3{0.4, 6, 1.1}};
    check_closed_form(
        "rectangle_light",
        integrator(2) + camera_above + floor_below +
            R"(<shape type="rectangle"><transform name="to_world"><scale x=".6" y="1" z="1"/>
            <rotate x="1" angle="90"/><translate x="1" y="6" z=".1"/></transform>
            <emitter type="area"><rgb name="radiance" value="7"/></emitter></shape>)",
        2048, [&](int x, int y) {
            double sum = 0;
            for (std::size_t i = 0; i < 4; ++i) {
                const dvec3 a = glm::normalize(corners[i] - floor_point(x, y));
                const dvec3 b = glm::normalize(corners[(i + 1) % 4] - floor_point(x, y));
                sum += std::acos(glm::dot(a, b)) * glm::normalize(glm::cross(a, b)).y;
            }
            return albedo / pi * 7 * std::abs(sum) / 2;
        });
}

TEST_CASE("glass of index 1 is invisible") {
    const std::string scene =
        integrator(-1, 20) + camera("0 2 6", "0 .3 0", "0 1 0") + floor_below +
        R"(<emitter type="constant"><rgb name="radiance" value=".4"/></emitter>
        <shape type="rectangle"><transform name="to_world"><scale value="2"/>
        <rotate x="1" angle="90"/><translate y="4"/></transform>
        <emitter type="area"><rgb name="radiance" value="3 2 1"/></emitter></shape>)";
    const std::string glass = R"(<shape type="sphere"><point name="center" x="0" y="1" z="0"/>
        <bsdf type="dielectric"><float name="int_ior" value="1"/><float name="ext_ior" value="1"/>
        </bsdf></shape>)";
    const auto verdict =
        compare_or_save("index_one", render_measured(scene_from_xml(scene + glass), {.spp = 4096}),
                        render_measured(scene_from_xml(scene), {.spp = 4096, .seed = 2}));
    INFO(verdict.summary);
    CHECK(verdict.passes);
}

// Light bounces inside a slab: T = (1-R)^2 (1 + R^2 + R^4 ...) = (1-R)/(1+R), at every angle.
TEST_CASE("a slab of glass transmits (1-R)/(1+R)") {
    const double eta = 1.5;
    check_closed_form(
        "slab",
        integrator(-1) + camera("0 0 2", "0 0 0", "0 1 0", 100) +
            R"(<shape type="cube"><transform name="to_world"><scale x="500" y="500" z=".1"/>
            </transform><bsdf type="dielectric"><float name="int_ior" value="1.5"/>
            <float name="ext_ior" value="1"/></bsdf></shape>
            <shape type="rectangle"><transform name="to_world"><scale value="200"/>
            <translate z="-1"/></transform>
            <emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>)",
        8192, [&](int x, int y) {
            const double tangent2 = slope(x, 100) * slope(x, 100) + slope(y, 100) * slope(y, 100);
            const double r = fresnel(1 / std::sqrt(1 + tangent2), eta);
            return (1 - r) / (1 + r);
        });
}

// A closed mirror of reflectance 1/2 that emits 1: max_depth n sees 1 + 1/2 + ... + 1/2^(n-1).
TEST_CASE("max_depth counts the edges of a path") {
    const int depth = GENERATE(1, 2, 3, 10);
    const auto picture = render_measured(
        scene_from_xml(integrator(depth) + camera(".1 .2 -.3", "0 0 1", "0 1 0") +
                       R"(<shape type="sphere"><boolean name="flip_normals" value="true"/>
            <bsdf type="conductor"><string name="material" value="none"/>
            <rgb name="specular_reflectance" value=".5"/></bsdf>
            <emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>)"),
        {.spp = 16});
    check_constant(picture.mean, 2 * (1 - std::pow(0.5, depth)), 1e-5);
}

TEST_CASE("glass and mirrors are lossless under a constant sky") {
    const auto picture = render_measured(
        scene_from_xml(integrator(-1) + camera("0 0 6", "0 0 0", "0 1 0") +
                       R"(<emitter type="constant"><rgb name="radiance" value="1"/></emitter>
            <shape type="sphere"><point name="center" x="-1" y="1" z="0"/>
            <bsdf type="dielectric"/></shape>
            <shape type="sphere"><point name="center" x="1" y="1" z="0"/>
            <bsdf type="conductor"/></shape>
            <shape type="cube"><transform name="to_world"><scale value=".6"/>
            <rotate x=".6" z=".8" angle="40"/><translate x="-.8" y="-1"/></transform>
            <bsdf type="dielectric"/></shape>)"),
        {.spp = 256});
    check_constant(picture.mean, 1, 1e-5);
}

TEST_CASE("what lets light pass, and blends and masks of it, are lossless under a constant sky") {
    const auto ball = [](double x, double y, const std::string &bsdf) {
        return fmt::format(R"(<shape type="sphere"><point name="center" x="{}" y="{}" z="0"/>
            <float name="radius" value=".8"/>{}</shape>)",
                           x, y, bsdf);
    };
    const std::string mirror = R"(<bsdf type="conductor"/>)",
                      glass = R"(<bsdf type="dielectric"/>)";
    const auto picture = render_measured(
        scene_from_xml(
            integrator(-1) + camera("0 0 6", "0 0 0", "0 1 0") +
            R"(<emitter type="constant"><rgb name="radiance" value="1"/></emitter>)" +
            ball(-1, 1, R"(<bsdf type="null"/>)") +
            ball(1, 1,
                 R"(<bsdf type="thindielectric"><float name="int_ior" value="1.9"/></bsdf>)") +
            ball(-1, -1,
                 R"(<bsdf type="mask"><float name="opacity" value=".3"/>
                    <bsdf type="twosided">)" +
                     mirror + "</bsdf></bsdf>") +
            ball(1, -1,
                 R"(<bsdf type="blendbsdf"><texture name="weight" type="checkerboard">
                    <rgb name="color0" value=".2"/><rgb name="color1" value=".7"/></texture>)" +
                     glass + R"(<bsdf type="twosided">)" + mirror + "</bsdf></bsdf>")),
        {.spp = 64});
    check_constant(picture.mean, 1, 1e-5);
}

// Behind a surface that lets light pass straight, hide_emitters hides a sky of 1 as from the camera
// itself. What such a surface reflects shows it: a sheet of glass R = 2 r / (1 + r), r being
// Fresnel's reflectance of one side straight on, .04 for an index of 1.5.
TEST_CASE("hide_emitters hides a sky behind passages") {
    const std::string xml =
        R"(<integrator type="path"><integer name="max_depth" value="6"/>
           <boolean name="hide_emitters" value="true"/></integrator>)" +
        camera("0 0 5", "0 0 0", "0 1 0", 4) +
        R"(<shape type="rectangle"><transform name="to_world"><translate x="-1"/></transform>
           <bsdf type="null"/></shape>
           <shape type="rectangle"><transform name="to_world"><translate x="1"/></transform>
           <bsdf type="thindielectric"><float name="int_ior" value="1.5"/>
           <float name="ext_ior" value="1"/></bsdf></shape>
           <emitter type="constant"><rgb name="radiance" value="1"/></emitter>)";
    const Image image = render_measured(scene_from_xml(xml), {.spp = 256}).mean;
    double hidden = 0, reflected = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size / 2; ++x) {
            hidden += std::abs(value_at(image, x, y));
            reflected += value_at(image, size / 2 + x, y) / (size * size / 2);
        }
    constexpr double share = 0.08 / 1.04;
    CHECK(hidden == 0);
    CHECK(reflected == Approx(share).margin(4 * std::sqrt(share / (256 * size * size / 2))));
}

// Without a sky alpha is the share of paths that meet something: the opacity a of a mask, and
// behind a mask of another one 1 - (1 - a)^2.
TEST_CASE("alpha is what masks stop") {
    std::string view = camera_above;
    view.replace(view.find("<rfilter"), 0, R"(<string name="pixel_format" value="rgba"/>)");
    const std::string mask = R"(<transform name="to_world"><rotate x="1" angle="-90"/>
        <scale value="20"/><translate y="{}"/></transform><bsdf type="mask">
        <float name="opacity" value=".25"/><bsdf type="diffuse"/></bsdf>)";
    const auto alpha = [&](int count) {
        std::string shapes;
        for (int i = 0; i < count; ++i)
            shapes +=
                "<shape type=\"rectangle\">" + fmt::format(fmt::runtime(mask), -i) + "</shape>";
        const auto picture =
            render_measured(scene_from_xml(integrator(-1) + view + shapes), {.spp = 256});
        return channel_mean(picture.mean, 3);
    };
    // Four standard errors of 2^16 independent paths.
    CHECK(alpha(1) == Approx(0.25).margin(4 * std::sqrt(0.25 * 0.75) / 256));
    CHECK(alpha(2) == Approx(0.4375).margin(4 * std::sqrt(0.4375 * 0.5625) / 256));
}

// A floor under two sheets that let all light pass, under a sky of 1: two edges bring its albedo
// where passages count for nothing (volpath), and no light where each is an edge (path).
TEST_CASE("max_depth counts passages as the scene's integrator does") {
    const std::string sheets = R"(<shape type="rectangle"><transform name="to_world">
        <rotate x="1" angle="-90"/><scale value="30"/><translate y="1"/></transform>
        <bsdf type="null"/></shape><shape type="rectangle"><transform name="to_world">
        <rotate x="1" angle="-90"/><scale value="30"/><translate y="2"/></transform>
        <bsdf type="null"/></shape><emitter type="constant"><rgb name="radiance" value="1"/>
        </emitter>)";
    const auto seen = [&](const std::string &type) {
        std::string how = integrator(2);
        how.replace(how.find("path"), 4, type);
        return render_measured(scene_from_xml(how + camera_above + floor_below + sheets),
                               {.spp = 16})
            .mean;
    };
    check_constant(seen("volpath"), albedo, 1e-5);
    const Image dark = seen("path");
    CHECK(std::all_of(dark.f32.begin(), dark.f32.end(), [](float value) { return value == 0; }));
}

// A lamp begins where the film ends, at its left. Of the tent filter of the leftmost pixels
// an eighth lies there, .131 with the filter's table of 31 steps; no sample of the film's own does.
TEST_CASE("sample_border brings the light beside the film") {
    std::string view = camera_above;
    view.replace(view.find("<rfilter type=\"box\"/>"), 21, R"(<rfilter type="tent"/>
        <boolean name="sample_border" value="true"/>)");
    const double edge = 5 * std::tan(20 * pi / 180);
    const auto picture = render_measured(
        scene_from_xml(integrator(1) + view +
                       fmt::format(R"(<shape type="rectangle"><transform name="to_world">
                           <rotate x="1" angle="-90"/><scale x="5" z="20"/>
                           <translate x="{}"/></transform><emitter type="area">
                           <rgb name="radiance" value="1"/></emitter></shape>)",
                                   edge + 5)),
        {.spp = 256});
    REQUIRE(picture.mean.width == size);
    REQUIRE(picture.mean.height == size);
    double left = 0;
    double elsewhere = 0;
    for (std::size_t i = 0; i < picture.mean.f32.size(); ++i)
        (i % (3 * size) < 3 ? left : elsewhere) += static_cast<double>(picture.mean.f32[i]);
    CHECK(left / (3 * size) == Approx(0.131).margin(0.01));
    CHECK(elsewhere == 0);
}

// The light's picture fills the film, one texel a pixel; row 0 of the file is at v = 0, y = -1.
TEST_CASE("pixel_centers looks exactly at the centres of the pixels") {
    std::string view = camera("0 0 5", "0 0 0", "0 1 0", 2 * std::atan(0.2) * 180 / pi);
    view.replace(view.find("\"height\" value=\"16\""), 19, "\"height\" value=\"12\"");
    const auto picture =
        render_measured(scene_from_xml(integrator(1) + view + R"(<shape type="rectangle">
            <transform name="to_world"><scale x="1" y=".75" z="1"/></transform>
            <emitter type="area"><texture name="radiance" type="bitmap">
            <string name="filename" value="data/pattern.exr"/>
            <string name="filter_type" value="nearest"/></texture></emitter></shape>)"),
                        {.spp = 4, .pixel_centers = true});
    const Image texture =
        read_image(std::string(CLRENDER_TEST_DIR) + "/references/data/pattern.exr");
    for (int y = 0; y < 12; ++y)
        for (int x = 0; x < 16; ++x)
            for (int c = 0; c < 3; ++c)
                CHECK(value_at(picture.mean, x, y, c) ==
                      Approx(value_at(texture, x, 11 - y, c)).epsilon(1e-5));
}

TEST_CASE("a light that nothing sees takes nothing from those that shine") {
    // A room and a ball in it, albedo .5, all of which emit 1: paths of up to 5 segments see
    // 1 + .5 + .25 + .125 + .0625. Inside the ball is a lamp a million times as bright.
    const std::string glow = R"(<bsdf type="diffuse"><rgb name="reflectance" value=".5"/></bsdf>
        <emitter type="area"><rgb name="radiance" value="1"/></emitter>)";
    const std::string room = R"(<shape type="cube"><transform name="to_world"><scale value="3"/>
        </transform><boolean name="flip_normals" value="true"/>)" +
                             glow + "</shape>" +
                             R"(<shape type="sphere"><float name="radius" value="0.5"/>)" + glow +
                             "</shape>";
    const std::string lamp = R"(<shape type="sphere"><float name="radius" value="0.2"/>
        <emitter type="area"><rgb name="radiance" value="1e6"/></emitter></shape>)";
    const Scene scene =
        scene_from_xml(integrator(5) + camera("0 0 -2.5", "0 0 0", "0 1 0") + room + lamp);
    for (const bool sobol : {false, true}) {
        TestRender how;
        how.spp = 256;
        how.sobol = sobol;
        const MeasuredImage measured = render_measured(scene, how);
        CHECK(channel_mean(measured.mean, 0) == Approx(1.9375).margin(0.005));
    }
}
