/// <spectrum type="...">, <blackbody> and the texture "scale" of Mitsuba 0.6. Mitsuba 3.9.1 refuses
/// blackbody, regular and irregular in its RGB mode: the numbers of the first are those of its
/// spectral mode, and the other two are what it makes of the same list in <spectrum value="...">.

#include "image/image.h"
#include "mitsuba_text_scene.h"
#include "stderr_of.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace clrender;
using namespace test;

namespace {

/// The radiance of a light.
Rgb radiance(const std::string &spectrum) {
    const Scene scene = load_text("<shape type=\"sphere\"><emitter type=\"area\">" + spectrum +
                                  "</emitter></shape>");
    return scene.textures.at(static_cast<std::size_t>(scene.emitters.at(0).radiance)).value;
}

std::string of_light(const std::string &type, const std::string &content) {
    return "<spectrum name=\"radiance\" type=\"" + type + "\">" + content + "</spectrum>";
}

/// The reflectance of a surface.
Texture reflectance(const std::string &texture, const std::string &version = "3.0.0") {
    const ScratchFolder folder;
    Image image;
    image.width = 2;
    image.height = image.channels = 1;
    image.f32 = {0.25f, 0.5f};
    write_image(folder.path("image.pfm"), image);
    Image colour;
    colour.width = colour.height = 1;
    colour.channels = 4;
    colour.f32 = {0.25f, 0.5f, 0.75f, 0.125f};
    write_image(folder.path("colour.exr"), colour);
    const Scene scene =
        load(folder.file("scene.xml", "<scene version=\"" + version +
                                          "\"><shape type=\"sphere\"><bsdf type=\"diffuse\">" +
                                          texture + "</bsdf></shape></scene>"));
    return scene.textures.back();
}

void check_close(const Rgb &value, const Rgb &expected, double tolerance) {
    for (int c = 0; c < 3; ++c) {
        CAPTURE(c, value[c], expected[c]);
        CHECK(std::abs(value[c] - expected[c]) <= tolerance * std::abs(expected[c]));
    }
}

} // namespace

TEST_CASE("black bodies", "[spectrum]") {
    const std::string hot = "<float name=\"temperature\" value=\"5000\"/>";
    const Rgb five = radiance(of_light("blackbody", hot));
    // Mitsuba's pictures are the mean of 65536 samples of four wavelengths.
    check_close(five, {15273.5, 12096.4, 9589.2}, 0.003);
    check_close(radiance(of_light("blackbody", "<float name=\"temperature\" value=\"3000\"/>")),
                {733.71, 349.93, 112.61}, 0.003);
    check_close(radiance(of_light("blackbody", hot + "<float name=\"scale\" value=\"2\"/>")),
                five * 2., 1e-9);
    // As Mitsuba 0.6 writes it.
    check_close(radiance(R"(<blackbody name="radiance" temperature="5000K" scale=".5"/>)"),
                five * .5, 1e-9);
}

TEST_CASE("lists of wavelengths", "[spectrum]") {
    const Rgb expected{.89709556, .3805383, .09809255};
    check_close(radiance(R"(<spectrum name="radiance" value="400:.1, 500:.2, 650:.9"/>)"), expected,
                1e-4);
    check_close(radiance(of_light("irregular", R"(<string name="wavelengths" value="400, 500, 650"/>
                                                  <string name="values" value=".1 .2 .9"/>)")),
                expected, 1e-4);
    check_close(radiance(of_light("regular", R"(<float name="wavelength_min" value="400"/>
        <float name="wavelength_max" value="700"/><string name="values" value=".1,.2,.5,.9"/>)")),
                radiance(R"(<spectrum name="radiance" value="400:.1,500:.2,600:.5,700:.9"/>)"),
                1e-9);
}

TEST_CASE("d65 and uniform", "[spectrum]") {
    CHECK(radiance(of_light("d65", "")) == Rgb(1));
    check_close(radiance(of_light("d65", R"(<float name="scale" value="3"/>
                                            <rgb name="color" value=".1 .2 .9"/>)")),
                {.3, .6, 2.7}, 1e-9);
    check_close(radiance(of_light("d65", R"(<spectrum type="uniform" name="x">
        <float name="value" value=".5"/></spectrum>)")),
                Rgb(.5), 1e-9);
    CHECK(radiance(of_light("uniform", R"(<float name="value" value=".5"/>
        <float name="wavelength_min" value="500"/>)")) == Rgb(.5));
}

TEST_CASE("malformed spectra", "[spectrum]") {
    const auto error = [](const std::string &type, const std::string &content) {
        return error_of_text("<shape type=\"sphere\"><emitter type=\"area\">" +
                             of_light(type, content) + "</emitter></shape>");
    };
    CHECK(error("blackbody", "").find("2: spectrum \"blackbody\": \"temperature\" is missing") ==
          0);
    CHECK(error("regular", "").find("2: spectrum \"regular\": \"wavelength_max\"") == 0);
    CHECK(error("irregular", R"(<string name="wavelengths" value="400 500"/>
                                <string name="values" value="1"/>)")
              .find("spectrum \"irregular\": \"values\" has not as many") != std::string::npos);
    CHECK(error("irregular", R"(<string name="wavelengths" value="500 400"/>
                                <string name="values" value="1 2"/>)")
              .find("do not ascend") != std::string::npos);
    CHECK(error_of_text(R"(<shape type="sphere"><bsdf type="diffuse"><spectrum name="reflectance"
        type="blackbody"><float name="temperature" value="3000"/></spectrum></bsdf></shape>)")
              .find("in a surface, expected it in a light") != std::string::npos);
}

TEST_CASE("one channel of a picture", "[spectrum]") {
    const auto channel = [](const std::string &name) {
        return reflectance(R"(<texture type="bitmap" name="reflectance">
            <string name="filename" value="colour.exr"/><string name="channel" value=")" +
                           name + "\"/></texture>")
            .bitmap->f32;
    };
    CHECK(channel("g") == std::vector<float>{.5f});
    CHECK(channel("a") == std::vector<float>{.125f});
}

TEST_CASE("scaled textures", "[spectrum]") {
    const std::string open =
        R"(<texture type="scale" name="reflectance"><float name="scale" value=".5"/>)";
    const Texture squares =
        reflectance(open + R"(<texture type="checkerboard"/></texture>)", "0.6.0");
    CHECK(squares.kind == TextureKind::checkerboard);
    check_close(squares.color0, Rgb(.2), 1e-9);
    check_close(squares.color1, Rgb(.1), 1e-9);
    const Texture picture = reflectance(
        R"(<texture type="scale" name="reflectance"><rgb name="scale" value="1 2 .5"/>
           <texture type="bitmap"><string name="filename" value="image.pfm"/>
           <string name="wrap_mode" value="clamp"/></texture></texture>)");
    std::vector<float> scaled; // as the device multiplies
    for (const float value : picture.bitmap->f32)
        for (int c = 0; c < 3; ++c)
            scaled.push_back(value * static_cast<float>(picture.scale[c]));
    CHECK(scaled == std::vector<float>{.25f, .5f, .125f, .5f, 1, .25f});
    CHECK(picture.wrap == TextureWrap::clamp);
    CHECK(reflectance(open + R"(<rgb name="value" value=".2 .4 .6"/></texture>)").value ==
          Rgb(.1, .2, .3));
    CHECK(error_of_text("<shape type=\"sphere\"><bsdf type=\"diffuse\">" + open +
                        "</texture></bsdf></shape>")
              .find("has no texture inside") != std::string::npos);
}
