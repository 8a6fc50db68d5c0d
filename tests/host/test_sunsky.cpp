/// The sky and the sun: their numbers are those of Mitsuba 3.9.1 (scalar_rgb, eval() and the
/// parameter sun_direction), which computes in single precision.

#include "flatten/flat_scene.h"
#include "mitsuba_text_scene.h"
#include "scene/sky_model.h"
#include "stderr_of.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace clrender;
using namespace test;

namespace {

Emitter sunsky(const std::string &content) {
    return load_text("<emitter type=\"sunsky\">" + content + "</emitter>").emitters.at(0);
}

/// An emitter of Mitsuba 0.6.
Emitter old_emitter(const std::string &type, const std::string &content) {
    const ScratchFolder folder;
    return load(folder.file("scene.xml", "<scene version=\"0.6.0\"><emitter type=\"" + type +
                                             "\">" + content + "</emitter></scene>"))
        .emitters.at(0);
}

std::string direction(const glm::dvec3 &d, const std::string &name = "sun_direction") {
    return "<vector name=\"" + name + "\" x=\"" + std::to_string(d.x) + "\" y=\"" +
           std::to_string(d.y) + "\" z=\"" + std::to_string(d.z) + "\"/>";
}

std::string number(const std::string &name, const std::string &value) {
    return "<float name=\"" + name + "\" value=\"" + value + "\"/>";
}

Rgb sky_at(const Emitter &emitter, const glm::dvec3 &direction) {
    const glm::dvec3 d = glm::normalize(direction);
    const glm::dvec3 up = glm::normalize(glm::dvec3(emitter.to_world[2]));
    const double cosine = glm::dot(d, emitter.sunsky.sun_direction);
    return emitter.sunsky.sky.at(glm::dot(d, up), std::acos(std::min(cosine, 1.0)));
}

void check_close(const Rgb &value, const Rgb &expected, double tolerance = 2e-4) {
    for (int c = 0; c < 3; ++c) {
        CAPTURE(c, value[c], expected[c]);
        CHECK(std::abs(value[c] - expected[c]) <= tolerance * std::abs(expected[c]));
    }
}

} // namespace

TEST_CASE("radiance of the sky and the sun", "[sunsky]") {
    struct Expected {
        double turbidity;
        std::string albedo;
        glm::dvec3 to_sun;
        Rgb at_sun, high, horizon, aside, sun;
    };
    const Expected skies[] = {
        {3,
         "",
         {0, .5, 1},
         {.1592918, .1899509, .2179508},
         {.09010356, .1181382, .1718368},
         {.1481892, .189491, .2202102},
         {.04479702, .07791441, .1454768},
         {62.9053, 52.81873, 40.93143}},
        {2.6,
         "<rgb name=\"albedo\" value=\".1 .9 .4\"/>",
         {.9, .1, .2},
         {.3377556, .3322383, .228533},
         {.01320132, .03009798, .04467893},
         {.5316849, .4536372, .2145911},
         {.02257381, .04752602, .06383143},
         {47.23566, 30.89194, 13.17923}},
        {10,
         "<float name=\"albedo\" value=\"0\"/>",
         {.3, -.3, .05},
         {.4984667, .2752396, .1058397},
         {.02207033, .02611521, .0295096},
         {.07652736, .04675518, .02401802},
         {.03369042, .03887166, .0400945},
         {1.369542, .5684123, .178666}},
        {1,
         "<float name=\"albedo\" value=\"1\"/>",
         {0, 0, 1},
         {.06527067, .1087304, .1618095},
         {.04209377, .08282429, .1615222},
         {.2512953, .3847386, .4546428},
         {.0574379, .1146292, .2075617},
         {65.16399, 55.33062, 43.71356}},
    };
    for (const Expected &sky : skies) {
        CAPTURE(sky.turbidity);
        const Emitter emitter =
            sunsky(number("turbidity", std::to_string(sky.turbidity)) + sky.albedo +
                   direction(sky.to_sun) + number("sun_aperture", "10"));
        check_close(sky_at(emitter, sky.to_sun), sky.at_sun);
        check_close(sky_at(emitter, {.3, .5, 1}), sky.high);
        check_close(sky_at(emitter, {1, 0, .02}), sky.horizon);
        check_close(sky_at(emitter, {-.5, .2, .4}), sky.aside);
        check_close(emitter.sunsky.sun_radiance, sky.sun, 1e-3); // Mitsuba's cosine of .268 degrees
    }
}

TEST_CASE("where the sun stands", "[sunsky]") {
    const auto close = [](const glm::dvec3 &a, const glm::dvec3 &b) {
        return glm::length(a - b) < 1e-3; // days since 2000 have three decimals in single precision
    };
    CHECK(close(sunsky("").sunsky.sun_direction, {.051385, .691748, .720308}));
    CHECK(close(sun_direction({2024, 2, 29, 8.5, 12, 30, 47.37, 8.54, 1}),
                {.467524, -.848862, .246686}));
    CHECK(close(sun_direction({1999, 12, 21, 12, 0, 0, -33.9, 151.2, 10}),
                {-.181458, .028648, .982981}));
    // Noon of the equinox on the equator, but for the equation of time.
    CHECK(sun_direction({2007, 3, 21, 12, 0, 0, 0, 0, 0}).z > std::cos(.04));
}

TEST_CASE("the scales and the aperture of a sunsky", "[sunsky]") {
    const std::string sun = direction({0, .5, 1});
    const Rgb plain = sunsky(sun).sunsky.sun_radiance;
    check_close(sunsky(sun + number("sun_scale", "3")).sunsky.sun_radiance, plain * 3., 1e-9);
    check_close(sunsky(sun + number("sky_scale", "3")).sunsky.sky.radiance,
                sunsky(sun).sunsky.sky.radiance * 3., 1e-9);
    // The irradiance stays the same.
    const double wide = 20 * 3.14159265358979 / 180;
    check_close(sunsky(sun + number("sun_aperture", "40")).sunsky.sun_radiance *
                    (1 - std::cos(wide)),
                plain * 2. * std::pow(std::sin(sun_half_angle / 2), 2), 1e-9);

    const FlatScene both = flatten(
        load_text("<shape type=\"sphere\"/><emitter type=\"sunsky\">" + sun + "</emitter>"));
    CHECK(both.facts.has_sky);
    REQUIRE(both.lights.size() == 1);
    CHECK(both.lights[0].kind == CLR_LIGHT_SUN);
    CHECK(both.frame.env_probability > 0.2);
    const FlatScene sky = flatten(load_text("<shape type=\"sphere\"/><emitter type=\"sunsky\">" +
                                            number("sun_scale", "0") + "</emitter>"));
    CHECK(sky.facts.has_sky);
    CHECK(sky.lights.empty());
    const FlatScene only_sun =
        flatten(load_text("<shape type=\"sphere\"/><emitter type=\"sunsky\">" +
                          number("sky_scale", "0") + "</emitter>"));
    CHECK_FALSE(only_sun.facts.has_sky);
    CHECK(only_sun.lights.size() == 1);
}

TEST_CASE("a sun below the horizon leaves the sky black", "[sunsky]") {
    Emitter emitter;
    const std::string said = stderr_of([&] { emitter = sunsky(direction({1, 0, -.1})); });
    CHECK(said.find("below the horizon") != std::string::npos);
    CHECK(emitter.sunsky.sun_radiance == Rgb(0));
    CHECK(emitter.sunsky.sky.radiance == Rgb(0));
}

TEST_CASE("the skies of Mitsuba 0.6", "[sunsky]") {
    const auto close = [](const glm::dvec3 &a, const glm::dvec3 &b) {
        return glm::length(a - b) < 1e-9;
    };
    // Up is +y, north -z, east +x; of the sunsky +z, -x, -y.
    const glm::dvec3 today = sun_direction({});
    const Emitter old = old_emitter("sunsky", "");
    CHECK(close(old.sunsky.sun_direction, {-today.y, today.z, today.x}));
    CHECK(close(glm::dvec3(old.to_world[2]), {0, 1, 0}));
    const Emitter turned =
        old_emitter("sky", R"(<transform name="toWorld"><rotate x="1" angle="90"/></transform>)");
    CHECK(close(glm::dvec3(turned.to_world[2]), {0, 0, 1}));
    // sunDirection is one of the world.
    CHECK(close(old_emitter("sun", direction({0, 2, 0}, "sunDirection")).sunsky.sun_direction,
                {0, 1, 0}));

    const Rgb sky = old.sunsky.sky.radiance, sun = old.sunsky.sun_radiance;
    const Emitter only_sky = old_emitter("sky", number("scale", "2"));
    CHECK(only_sky.sunsky.sky.radiance == sky * 2.);
    CHECK(only_sky.sunsky.sun_radiance == Rgb(0));
    const Emitter only_sun = old_emitter("sun", number("scale", "2"));
    CHECK(only_sun.sunsky.sky.radiance == Rgb(0));
    CHECK(only_sun.sunsky.sun_radiance == sun * 2.);
    const Emitter scaled = old_emitter("sunsky", number("skyScale", "3") + number("scale", "2") +
                                                     number("sunRadiusScale", "10"));
    CHECK(scaled.sunsky.sky.radiance == sky * 3.);
    CHECK(scaled.sunsky.half_aperture == Approx(10 * sun_half_angle));
    CHECK(old_emitter("sunsky", number("sunRadiusScale", "0")).sunsky.half_aperture < 1e-4);
}

TEST_CASE("malformed skies", "[sunsky]") {
    const auto error = [](const std::string &content) {
        return error_of_text("<emitter type=\"sunsky\">" + content + "</emitter>");
    };
    const std::string place = "2: emitter \"sunsky\": ";
    CHECK(error(number("turbidity", ".5")).find(place + "\"turbidity\" is out of range") == 0);
    CHECK(error("<rgb name=\"albedo\" value=\"2 0 0\"/>").find(place + "\"albedo\" is above 1") ==
          0);
    CHECK(error(number("sun_scale", "-1")).find(place + "\"sun_scale\" is out of range") == 0);
    CHECK(error(number("sun_aperture", "0")).find(place + "\"sun_aperture\" is out of range") == 0);
    CHECK(error(direction({0, 0, 0})).find(place + "\"sun_direction\" has no length") == 0);
    CHECK(error(direction({0, 0, 1}) + number("hour", "3"))
              .find(place + "\"hour\" and sun_direction") == 0);
    CHECK(error("<integer name=\"month\" value=\"13\"/>").find(place + "\"month\"") == 0);
    CHECK(error("<transform name=\"to_world\"><scale x=\"2\"/></transform>")
              .find(place + "\"to_world\" shears") == 0);
    CHECK(error("</emitter><emitter type=\"constant\">").find("second environment") !=
          std::string::npos);
}
