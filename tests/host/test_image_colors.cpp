/// What the numbers of a picture mean: channels by their names, primaries, encodings, and numbers
/// that no renderer can use.

#include "exr_bytes.h"
#include "files.h"
#include "mitsuba_text_scene.h"
#include "stderr_of.h"

#include "film/film.h"
#include "image/color.h"
#include "image/image.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <limits>

using namespace clrender;
using test::exr_pixel;

namespace {

struct Reading {
    Image image;
    std::string messages;
};

Reading read_bytes(const std::string &bytes, const std::string &name = "a.exr", bool raw = false) {
    const test::ScratchFolder folder;
    const std::string path = folder.file(name, bytes);
    Reading reading;
    reading.messages = test::stderr_of([&] { reading.image = read_image(path, {}, raw); });
    return reading;
}

/// A film of one pixel with one sample.
Film film_of(const glm::dvec4 &rgba) {
    __extension__ using Bits = unsigned __int128;
    FilmPixel pixel{};
    for (int c = 0; c < 4; ++c) {
        const auto sum =
            static_cast<Bits>(std::ldexp(static_cast<long double>(rgba[c]), -CLR_COLOUR_LSB));
        for (int word = 0; word < std::min<int>(4, std::size(pixel.colour)); ++word)
            pixel.colour[word][c] = static_cast<uint>(sum >> (32 * word));
    }
    const auto weight = std::uint64_t{1} << static_cast<unsigned>(-CLR_WEIGHT_LSB);
    pixel.weight[0] = static_cast<uint>(weight);
    pixel.weight[1] = static_cast<uint>(weight >> 32U);
    pixel.samples = 1;
    Film film;
    film.width = film.height = 1;
    film.pixels = {pixel};
    return film;
}

/// NaN fails.
bool is_near(const std::vector<float> &values, const std::vector<double> &expected,
             double tolerance) {
    if (values.size() != expected.size())
        return false;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!(std::abs(static_cast<double>(values[i]) - expected[i]) <= tolerance))
            return false;
    return true;
}

bool has(const std::string &text, const std::string &part) {
    return text.find(part) != std::string::npos;
}

} // namespace

TEST_CASE("EXR channels in any case and under their names", "[image]") {
    const std::vector<float> expected{.25F, .5F, .75F};
    for (const std::array<const char *, 3> &names :
         {std::array{"R", "G", "B"},
          {"r", "g", "b"},
          {"red", "green", "blue"},
          {"Red", "Green", "Blue"},
          {"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B"},
          {"beauty.red", "beauty.green", "beauty.blue"}}) {
        CAPTURE(names[0]);
        const Reading read = read_bytes(
            exr_pixel({{names[0], .25}, {names[1], .5}, {names[2], .75}, {"Depth.Z", 4}}));
        CHECK(read.image.channels == 3);
        CHECK(read.image.f32 == expected);
        CHECK(read.messages.empty());
    }
    CHECK(read_bytes(exr_pixel({{"r", .25}, {"g", .5}, {"b", .75}, {"a", .125}})).image.f32 ==
          std::vector<float>{.25F, .5F, .75F, .125F});
    for (const char *name : {"Y", "y", "luminance", "Gray", "l"})
        CHECK(read_bytes(exr_pixel({{name, .5}})).image.f32 == std::vector<float>{.5F});
    // Exact names go before others.
    CHECK(
        read_bytes(exr_pixel({{"R", .25}, {"G", .5}, {"B", .75}, {"r", 9}, {"b", 9}})).image.f32 ==
        expected);
    for (const auto &bad : {exr_pixel({{"R", 1}, {"G", 1}}), exr_pixel({{"Depth.Z", 1}}),
                            exr_pixel({{"U", 1}, {"V", 1}})})
        CHECK(has(test::error_of([&] { read_bytes(bad); }), "expected R, G, B or X, Y, Z or Y"));
}

TEST_CASE("of several EXR layers one is read, and said to be", "[image]") {
    const auto layer = [](const std::string &name, double value) {
        return std::vector<std::pair<std::string, double>>{
            {name + "R", value}, {name + "G", value}, {name + "B", value}};
    };
    const auto both = [&](const std::string &a, const std::string &b) {
        auto all = layer(a, .25);
        const auto more = layer(b, .5);
        all.insert(all.end(), more.begin(), more.end());
        all.insert(all.end(), {{"Normal.X", 1}, {"Normal.Y", 1}, {"Normal.Z", 1}});
        return read_bytes(exr_pixel(all));
    };
    const Reading unnamed = both("a.", "");
    CHECK(unnamed.image.f32 == std::vector<float>(3, .5F));
    CHECK(unnamed.messages.empty());
    const Reading whole = both("Albedo.", "View.Combined.");
    CHECK(whole.image.f32 == std::vector<float>(3, .5F));
    CHECK(has(whole.messages,
              "a.exr: warning: layer View.Combined is read, these are not: Albedo, Normal"));
    const Reading first = both("diffuse.", "specular.");
    CHECK(first.image.f32 == std::vector<float>(3, .25F));
    CHECK(has(first.messages, "layer diffuse is read, these are not: Normal, specular"));
}

TEST_CASE("EXR channels of every type", "[image]") {
    // 0.5 and 1 as half; whole numbers as they are.
    CHECK(read_bytes(test::exr_bytes(2, 1, {{"Y", test::ExrType::half, {0x3800, 0x3c00}}}))
              .image.f32 == std::vector<float>{.5F, 1});
    CHECK(read_bytes(test::exr_bytes(2, 1, {{"Y", test::ExrType::uint32, {3, 70000}}})).image.f32 ==
          std::vector<float>{3, 70000});
    // Red is a half, green a float, blue a whole number.
    CHECK(read_bytes(test::exr_bytes(1, 1,
                                     {{"R", test::ExrType::half, {0x3800}},
                                      {"G", test::ExrType::float32, {.1}},
                                      {"B", test::ExrType::uint32, {2}}}))
              .image.f32 == std::vector<float>{.5F, .1F, 2});
}

TEST_CASE("EXR files of XYZ become linear sRGB", "[image]") {
    // The white of sRGB, and its three primaries (IEC 61966-2-1), to four places.
    const std::vector<std::pair<glm::dvec3, glm::dvec3>> pairs{{{.9505, 1, 1.089}, {1, 1, 1}},
                                                               {{.4124, .2126, .0193}, {1, 0, 0}},
                                                               {{.3576, .7152, .1192}, {0, 1, 0}},
                                                               {{.1805, .0722, .9505}, {0, 0, 1}}};
    for (const auto &[xyz, rgb] : pairs) {
        const Reading read = read_bytes(exr_pixel({{"X", xyz.x}, {"Y", xyz.y}, {"Z", xyz.z}}));
        CHECK(is_near(read.image.f32, {rgb.r, rgb.g, rgb.b}, 1e-3));
        CHECK(read.image.color_space == ColorSpace::srgb);
        // The same numbers in channels that only the attribute says to be X, Y and Z.
        const Reading by_attribute = read_bytes(exr_pixel(
            {{"R", xyz.x}, {"G", xyz.y}, {"B", xyz.z}}, {1, 0, 0, 1, 0, 0, 1 / 3.F, 1 / 3.F}));
        CHECK(is_near(by_attribute.image.f32, {rgb.r, rgb.g, rgb.b}, 1e-3));
    }
}

TEST_CASE("EXR chromaticities are converted without adapting the white", "[image]") {
    const std::vector<std::pair<std::string, double>> pixel{{"R", .6}, {"G", .1}, {"B", .05}};
    const auto read = [&](const std::vector<float> &chromaticities) {
        return read_bytes(exr_pixel(pixel, chromaticities));
    };
    // ACES AP0; the values are those of Mitsuba 3.9.1.
    CHECK(is_near(read({.7347F, .2653F, 0, 1, .0001F, -.077F, .32168F, .33767F}).image.f32,
                  {1.4034935, -.03486415, .02889556}, 1e-5));
    // Those of sRGB, and as good as those, change no bit.
    const std::vector<float> same{.6F, .1F, .05F};
    CHECK(read({.64F, .33F, .3F, .6F, .15F, .06F, .3127F, .329F}).image.f32 == same);
    CHECK(read({.64F, .33F, .3F, .6F, .15F, .06F, .31271F, .32902F}).image.f32 == same);
    // Rec. 2020 has the same white; red of it is (1.6605, -.1246, -.0182) (ITU-R BT.2087).
    const Reading red = read_bytes(exr_pixel(
        {{"R", 1}, {"G", 0}, {"B", 0}}, {.708F, .292F, .17F, .797F, .131F, .046F, .3127F, .329F}));
    CHECK(is_near(red.image.f32, {1.6605, -.1246, -.0182}, 1e-4));
    // A line instead of a triangle, a white without luminance, no numbers.
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const std::vector<float> &bad : {std::vector<float>(8, .3F),
                                          {.64F, .33F, .3F, .6F, .15F, .06F, .3F, 0},
                                          std::vector<float>(8, nan)}) {
        const Reading ignored = read(bad);
        CHECK(ignored.image.f32 == same);
        CHECK(has(ignored.messages, "chromaticities span no colour space"));
    }
}

TEST_CASE("EXR luma and chroma become RGB", "[image]") {
    // Y = .2126 R + .7152 G + .0722 B, RY = (R - Y) / Y, BY = (B - Y) / Y of (.6, .1, .05), evenly.
    const double luma = .2126 * .6 + .7152 * .1 + .0722 * .05;
    const std::size_t count = 16;
    for (const bool has_alpha : {false, true}) {
        std::vector<test::ExrChannel> channels{
            {"Y", test::ExrType::float32, std::vector<double>(count, luma)},
            {"RY", test::ExrType::float32, std::vector<double>(count / 4, (.6 - luma) / luma), 2},
            {"BY", test::ExrType::float32, std::vector<double>(count / 4, (.05 - luma) / luma), 2}};
        if (has_alpha)
            channels.push_back({"A", test::ExrType::float32, std::vector<double>(count, .5)});
        const Reading read = read_bytes(test::exr_bytes(4, 4, channels));
        REQUIRE(read.image.channels == (has_alpha ? 4 : 3));
        std::vector<double> expected;
        for (std::size_t i = 0; i < count; ++i) {
            expected.insert(expected.end(), {.6, .1, .05});
            if (has_alpha)
                expected.push_back(.5);
        }
        CHECK(is_near(read.image.f32, expected, 1e-3)); // half has 11 bits
    }
}

TEST_CASE("16-bit PNG is raw or sRGB, alpha always linear", "[image]") {
    // One pixel each, stored without compression: 200/255 = 51400/65535 in every colour, alpha
    // half.
    const auto crc = [](const std::string &bytes) {
        std::uint32_t c = 0xffffffff;
        for (const char byte : bytes) {
            c ^= static_cast<unsigned char>(byte);
            for (int k = 0; k < 8; ++k)
                c = (c & 1) != 0 ? 0xedb88320U ^ (c >> 1) : c >> 1;
        }
        return c ^ 0xffffffff;
    };
    const auto big = [](std::uint32_t v) {
        std::string bytes;
        for (int shift = 24; shift >= 0; shift -= 8)
            bytes += static_cast<char>(v >> static_cast<unsigned>(shift));
        return bytes;
    };
    const auto chunk = [&](const std::string &typed) {
        return big(static_cast<std::uint32_t>(typed.size() - 4)) + typed + big(crc(typed));
    };
    const auto png = [&](int channels, bool is_16bit) {
        const char color_type = std::string("\0\0\4\2\6", 5)[static_cast<std::size_t>(channels)];
        std::string row(1, '\0');
        for (int c = 0; c < channels; ++c) {
            const bool is_alpha = channels % 2 == 0 && c == channels - 1;
            row += static_cast<char>(is_alpha ? 128 : 200);
            if (is_16bit)
                row += static_cast<char>(is_alpha ? 128 : 200);
        }
        std::uint32_t a = 1;
        std::uint32_t b = 0;
        for (const char byte : row) {
            a = (a + static_cast<unsigned char>(byte)) % 65521;
            b = (b + a) % 65521;
        }
        const auto size = static_cast<char>(row.size());
        const std::string stored = std::string("\x78\x01\x01", 3) + size + '\0' +
                                   static_cast<char>(~size) + '\xff' + row + big(b << 16 | a);
        return "\x89PNG\r\n\x1a\n" +
               chunk("IHDR" + big(1) + big(1) + (is_16bit ? '\x10' : '\x8') + color_type +
                     std::string(3, '\0')) +
               // A gamma that would matter, were it not left out of account (as in Mitsuba).
               chunk("gAMA" + big(100000)) + chunk("IDAT" + stored) + chunk("IEND");
    };
    for (const int channels : {1, 2, 3, 4})
        for (const bool raw : {false, true}) {
            CAPTURE(channels, raw);
            std::vector<double> expected(static_cast<std::size_t>(channels),
                                         raw ? 200 / 255. : .57758);
            if (channels % 2 == 0)
                expected.back() = 128 / 255.;
            const Reading deep = read_bytes(png(channels, true), "a.png", raw);
            CHECK(deep.image.channels == channels);
            CHECK(is_near(deep.image.f32, expected, 1e-5));
            CHECK(read_bytes(png(channels, false), "a.png", raw).image.u8.at(0) == 200);
        }

    // One scene with both: two images.
    const test::ScratchFolder folder;
    (void)folder.file("t.png", png(3, true));
    const auto texture = [](const char *raw) {
        return fmt::format("<shape type='sphere'><bsdf type='diffuse'><texture type='bitmap' "
                           "name='reflectance'><string name='filename' value='t.png'/><boolean "
                           "name='raw' value='{}'/></texture></bsdf></shape>",
                           raw);
    };
    const std::string path = folder.file("s.xml", "<scene version='3.0.0'>" + texture("true") +
                                                      texture("false") + "</scene>");
    Scene scene;
    test::stderr_of([&] { scene = test::load(path); });
    CHECK(is_near({scene.textures.at(0).bitmap->f32.at(0), scene.textures.at(1).bitmap->f32.at(0)},
                  {200 / 255., .57758}, 1e-5));
}

namespace {

/// The reflectance of a scene whose texture or environment map is that file.
Reading read_in_scene(const std::string &bytes, bool is_light) {
    const test::ScratchFolder folder;
    (void)folder.file("t.exr", bytes);
    const std::string path = folder.file(
        "s.xml", std::string("<scene version='3.0.0'>\n") +
                     (is_light ? "<emitter type='envmap'>"
                               : "<shape type='sphere'><bsdf type='diffuse'><texture type='bitmap' "
                                 "name='reflectance'>") +
                     "<string name='filename' value='t.exr'/>" +
                     (is_light ? "</emitter>" : "</texture></bsdf></shape>") + "</scene>");
    Reading reading;
    Scene scene;
    reading.messages = test::stderr_of([&] { scene = test::load(path); });
    reading.image = is_light ? *scene.emitters.at(0).bitmap : *scene.textures.at(0).bitmap;
    return reading;
}

} // namespace

TEST_CASE("values that are infinite, no numbers or negative are replaced, and said", "[image]") {
    const double inf = std::numeric_limits<double>::infinity();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<double> values{.5, inf, 3, nan, -inf, -1, inf, 2, 0};
    const std::string bytes = test::exr_bytes(3, 3, {{"Y", test::ExrType::float32, values}});
    for (const bool is_light : {false, true}) {
        const Reading read = read_in_scene(bytes, is_light);
        CHECK(read.image.f32 == std::vector<float>{.5F, 3, 3, 0, 0, 0, 3, 2, 0});
        CHECK(has(read.messages, "s.xml:2: warning: "));
        CHECK(has(read.messages,
                  "t.exr: 2 values are infinite, 3 instead, the largest finite value "
                  "(pixel (1, 0) has the first)\n"));
        CHECK(has(read.messages, "t.exr: 1 value is not a number, 0 instead (pixel (0, 1))\n"));
        CHECK(has(read.messages,
                  "t.exr: 2 values are negative, 0 instead (pixel (1, 1) has the first)"));
    }
    // Half: 0x7c00 is infinite, 0x7bff is 65504, the largest.
    const Reading half = read_in_scene(
        test::exr_bytes(2, 3, {{"Y", test::ExrType::half, {0x7c00, 0x7bff, 0, 0, 0, 0}}}), true);
    CHECK(half.image.f32.at(0) == 65504);
    const Reading all_bad = read_in_scene(
        test::exr_bytes(2, 3, {{"Y", test::ExrType::float32, {inf, nan, inf, inf, inf, inf}}}),
        true);
    CHECK(all_bad.image.f32 == std::vector<float>(6, 0));
}

TEST_CASE("colours outside of sRGB stay negative in a reflectance, not in a light", "[image]") {
    std::vector<test::ExrChannel> channels;
    for (const auto &[name, value] : {std::pair{"R", .6}, {"G", .1}, {"B", .05}})
        channels.push_back({name, test::ExrType::float32, std::vector<double>(6, value)});
    const std::string bytes =
        test::exr_bytes(2, 3, channels, {.7347F, .2653F, 0, 1, .0001F, -.077F, .32168F, .33767F});
    const Reading reflectance = read_in_scene(bytes, false);
    CHECK(reflectance.image.f32.at(1) == Approx(-.03486415));
    CHECK_FALSE(has(reflectance.messages, "negative"));
    const Reading light = read_in_scene(bytes, true);
    CHECK(light.image.f32.at(1) == 0);
    CHECK(has(light.messages, "6 values are negative, 0 instead"));
}

TEST_CASE("a film in XYZ is written as what it is, or as linear sRGB", "[image]") {
    const Film film = film_of({.8, .2, .1, 1});
    // IEC 61966-2-1, to four places.
    const std::vector<double> xyz{.4124 * .8 + .3576 * .2 + .1805 * .1,
                                  .2126 * .8 + .7152 * .2 + .0722 * .1,
                                  .0193 * .8 + .1192 * .2 + .9505 * .1};
    const test::ScratchFolder folder;
    for (const PixelFormat format : {PixelFormat::xyz, PixelFormat::xyza}) {
        const Image image = film_mean(film, format);
        CHECK(is_near({image.f32[0], image.f32[1], image.f32[2]}, xyz, 1e-3));
        const std::string messages = test::stderr_of([&] {
            for (const char *name : {"a.exr", "a.pfm", "a.hdr", "a.png"})
                write_image(folder.path(name), image, 0, {}, {{"variance", &image}});
        });
        CHECK(has(messages, "a.pfm: warning: the XYZ of the film is written as linear sRGB"));
        CHECK(has(messages, "a.hdr: warning: "));
        CHECK_FALSE(has(messages, "a.png"));
        CHECK_FALSE(has(messages, "a.exr"));

        // The EXR has channels X, Y, Z and their chromaticities; all say the same colour.
        const std::string bytes = test::read_bytes(folder.path("a.exr"));
        for (const std::string &part : {std::string("\0X\0\2", 4), std::string("\0Z\0\2", 4),
                                        std::string("variance.X"), std::string("chromaticities")})
            CHECK(has(bytes, part));
        CHECK_FALSE(has(bytes, std::string("\0R\0\2", 4)));
        for (const char *name : {"a.exr", "a.pfm", "a.hdr"}) {
            CAPTURE(name);
            const Image back = read_image(folder.path(name));
            CHECK(is_near({back.f32[0], back.f32[1], back.f32[2]}, {.8, .2, .1}, 4e-3));
        }
        const Image png = read_image(folder.path("a.png"));
        CHECK(png.u8.at(0) == std::lround(255 * srgb_encode(.8)));
        CHECK(png.u8.at(1) == std::lround(255 * srgb_encode(.2)));
    }
}

TEST_CASE("a film of luminance is written as grey", "[image]") {
    const Film film = film_of({0, 1, 0, .5});
    const test::ScratchFolder folder;
    for (const PixelFormat format : {PixelFormat::luminance, PixelFormat::luminance_alpha}) {
        const Image image = film_mean(film, format);
        for (const char *name : {"a.exr", "a.pfm", "a.hdr"}) {
            write_image(folder.path(name), image);
            const Image back = read_image(folder.path(name));
            CHECK(back.f32.at(0) == Approx(.7152).epsilon(.004));
        }
        CHECK(has(test::read_bytes(folder.path("a.exr")), std::string("\0Y\0\2", 4)));
    }
}
