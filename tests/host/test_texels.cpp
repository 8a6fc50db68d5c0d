/// How the numbers of pictures become colours: encoding, and the precision they are kept in.

#include "flatten/flat_scene.h"
#include "image/texels.h"
#include "mitsuba_text_scene.h"

#include <catch2/catch.hpp>

using namespace clrender;
using namespace test;

namespace {

/// Two rows of two pixels, all with this value.
std::string pfm(float value) {
    const float pixels[4] = {value, value, value, value};
    return "Pf\n2 2\n-1\n" + std::string(reinterpret_cast<const char *>(pixels), sizeof(pixels));
}

std::string textured(const std::string &file, const std::string &format) {
    return R"(<shape type="sphere"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">
        <string name="filename" value=")" +
           file + R"("/><string name="format" value=")" + format +
           R"("/></texture></bsdf></shape>)";
}

} // namespace

TEST_CASE("bytes are decoded from sRGB, raw ones are not, and half precision rounds") {
    // The values that Mitsuba 3.9.1 gives for a byte of 55 (scalar_rgb, format auto and fp16).
    CHECK(decode_bytes({})[55] == Approx(0.03820433).epsilon(2e-6));
    CHECK(decode_bytes({.half = true})[55] == 0.0382080078125);
    CHECK(decode_bytes({.raw = true})[51] == Approx(0.2).epsilon(1e-14));
    CHECK(decode_bytes({.raw = true, .half = true})[255] == 1);
}

TEST_CASE("half precision holds what is larger as its largest number") {
    CHECK(round_to_half(0.1234567) == 0.12347412109375); // as Mitsuba
    CHECK(round_to_half(1e5) == 65504);
    CHECK(round_to_half(-1e5) == -65504);
}

TEST_CASE("grey pictures give all channels the same, alpha none") {
    Image image;
    image.channels = 2;
    image.f32 = {.25F, 1, .5F, 0};
    CHECK(texel_color(image, 1) == glm::dvec3(.5));
    image.channels = 4;
    image.f32 = {1, 2, 3, 0, 4, 5, 6, 0};
    CHECK(texel_color(image, 1) == glm::dvec3(4, 5, 6));
}

TEST_CASE("a picture in two formats is kept twice, in one format once") {
    const ScratchFolder folder;
    const std::string file = folder.file("map.pfm", pfm(0.1234567F));
    const auto flat_of = [&](const std::string &first, const std::string &second) {
        return flatten(load_text(textured(file, first) + textured(file, second)));
    };
    const FlatScene both = flat_of("variant", "fp16");
    REQUIRE(both.textures.size() == 2);
    REQUIRE(both.texels_f32.size() == 2 * 3 * 4);
    CHECK(both.texels_f32[3 * both.textures[0].offset] == 0.1234567F);
    CHECK(both.texels_f32[3 * both.textures[1].offset] == 0.12347412109375F);
    const FlatScene same = flat_of("auto", "variant");
    REQUIRE(same.textures.size() == 2);
    CHECK(same.texels_f32.size() == 3 * 4);
    CHECK(same.textures[0].offset == same.textures[1].offset);
}

TEST_CASE("the format of a bitmap is one of three") {
    CHECK_THAT(error_of_text(textured("map.pfm", "fp32")),
               Catch::Contains("\"format\"") && Catch::Contains("fp16"));
}
