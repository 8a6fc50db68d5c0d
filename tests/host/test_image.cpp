#include "files.h"

#include "image/image.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>

#include <cmath>

using namespace clrender;

namespace {

/// A small gradient with values below 0, above 1 and awkward ones between.
Image gradient(int channels) {
    Image image;
    image.width = 19;
    image.height = 7;
    image.channels = channels;
    for (int i = 0; i < image.width * image.height * channels; ++i)
        image.f32.push_back(0.013F * static_cast<float>(i) + 1e-4F);
    return image;
}

Image round_trip(const Image &image, const std::string &name, double exposure = 0) {
    const test::ScratchFolder folder;
    write_image(folder.path(name), image, exposure);
    CHECK(folder.count() == 1);
    return read_image(folder.path(name));
}

} // namespace

TEST_CASE("EXR and PFM keep every bit", "[image]") {
    for (const int channels : {1, 3}) {
        const Image image = gradient(channels);
        for (const char *name : {"a.exr", "a.pfm"}) {
            const Image back = round_trip(image, name);
            CHECK(back.channels == channels);
            CHECK(back.f32 == image.f32);
        }
    }
    const Image rgba = gradient(4);
    CHECK(round_trip(rgba, "a.EXR").f32 == rgba.f32);
}

TEST_CASE("HDR keeps eight bits of the largest channel", "[image]") {
    const Image image = gradient(3);
    const Image back = round_trip(image, "a.hdr");
    REQUIRE(back.f32.size() == image.f32.size());
    for (std::size_t i = 0; i < image.f32.size(); i += 3) {
        const float largest = std::max({image.f32[i], image.f32[i + 1], image.f32[i + 2]});
        for (std::size_t c = 0; c < 3; ++c)
            CHECK(std::abs(back.f32[i + c] - image.f32[i + c]) <= largest / 128);
    }
}

TEST_CASE("RGBE pixels have the values that Mitsuba gives them", "[image]") {
    // From mi.Bitmap of Mitsuba 3.9.1: no half is added to the mantissas.
    const test::ScratchFolder folder;
    std::string bytes = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 3\n";
    for (const int byte : {128, 64, 32, 129, 1, 255, 0, 136, 0, 0, 0, 0})
        bytes += static_cast<char>(byte);
    const Image image = read_image(folder.file("a.hdr", bytes));
    CHECK(image.f32 == std::vector<float>{1, 0.5F, 0.25F, 1, 255, 0, 0, 0, 0});
}

TEST_CASE("PFM of either byte order, with a scale", "[image]") {
    // 1 and 2 in both orders; the bottom row is the first in the file; times |scale| (as Mitsuba).
    const test::ScratchFolder folder;
    const std::string little("Pf\n1 2\n-2.0\n\0\0\x80\x3f\0\0\0\x40", 20);
    const std::string big("Pf\n1 2\n2.0\n\x3f\x80\0\0\x40\0\0\0", 19);
    for (const std::string &bytes : {little, big})
        CHECK(read_image(folder.file("a.pfm", bytes)).f32 == std::vector<float>{4, 2});
}

TEST_CASE("8-bit formats are sRGB, exposed, clamped and rounded", "[image]") {
    Image image;
    image.width = 5;
    image.height = 1;
    image.channels = 1;
    image.f32 = {-1, 0, 0.25F, 10, std::nanf("")};
    const Image back = round_trip(image, "a.png", 1);
    REQUIRE(back.type == PixelType::u8);
    CHECK(back.u8 == std::vector<std::uint8_t>{0, 0, 188, 255, 0});
    CHECK(srgb_decode(srgb_encode(0.3)) == Approx(0.3));
}

TEST_CASE("every 8-bit value survives PNG", "[image]") {
    Image image;
    image.width = 256;
    image.height = 1;
    image.channels = 1;
    for (int i = 0; i < 256; ++i)
        image.f32.push_back(static_cast<float>(srgb_decode(i / 255.0)));
    const Image back = round_trip(image, "a.png");
    for (int i = 0; i < 256; ++i)
        CHECK(back.u8[static_cast<std::size_t>(i)] == i);
}

TEST_CASE("JPEG is close, and has no alpha", "[image]") {
    Image image = gradient(4);
    image.f32.assign(image.f32.size(), 0.5F);
    const Image back = round_trip(image, "a.jpg");
    REQUIRE(back.channels == 3);
    for (const std::uint8_t value : back.u8)
        CHECK(std::abs(value - 188) <= 2);
}

TEST_CASE("EXR metadata and layers", "[image]") {
    const test::ScratchFolder folder;
    const Image image = gradient(3);
    write_image(folder.path("a.exr"), image, 0, {{"scene", "spheres"}}, {{"variance", &image}});
    const std::string bytes = test::read_bytes(folder.path("a.exr"));
    CHECK(bytes.find("spheres") != std::string::npos);
    CHECK(bytes.find("variance.G") != std::string::npos);
    CHECK(read_image(folder.path("a.exr")).f32 == image.f32);
}

TEST_CASE("an image cut at any byte is an error", "[image]") {
    const test::ScratchFolder folder;
    for (const char *name : {"a.png", "a.jpg", "a.hdr", "a.pfm", "a.exr"}) {
        write_image(folder.path(name), gradient(3));
        const std::string path = folder.path(name);
        for (auto length = std::filesystem::file_size(path); length-- > 0;) {
            std::filesystem::resize_file(path, length);
            INFO(name << " cut at " << length);
            CHECK_THROWS_AS(read_image(path), InputError);
        }
    }
}

TEST_CASE("an image with a damaged byte is an image or an error", "[image]") {
    const test::ScratchFolder folder;
    for (const char *name : {"a.png", "a.jpg", "a.hdr", "a.pfm", "a.exr"}) {
        write_image(folder.path(name), gradient(3));
        const std::string whole = test::read_bytes(folder.path(name));
        for (std::size_t i = 0; i < std::min<std::size_t>(whole.size(), 600); ++i) {
            std::fstream file(folder.path(name), std::ios::in | std::ios::out | std::ios::binary);
            file.seekp(static_cast<std::streamoff>(i)).put(static_cast<char>(whole[i] ^ 0x81));
            file.flush();
            try {
                (void)read_image(folder.path(name));
            } catch (const InputError &) {
            }
            file.seekp(static_cast<std::streamoff>(i)).put(whole[i]);
        }
    }
}

TEST_CASE("what cannot be written leaves the old file and nothing else", "[image]") {
    const test::ScratchFolder folder;
    const std::string old = folder.file("old.png", "old");
    Image empty;
    CHECK_THROWS_AS(write_image(old, empty), InputError);
    CHECK(test::read_bytes(old) == "old");
    CHECK_THROWS_AS(write_image(folder.path("none/a.png"), gradient(3)), OutputError);
    CHECK_THROWS_AS(write_image(folder.path("a.gif"), gradient(3)), InputError);
    REQUIRE(::mkdir(folder.path("folder.png").c_str(), 0700) == 0);
    CHECK_THROWS_AS(write_image(folder.path("folder.png"), gradient(3)), OutputError);
    CHECK(folder.count() == 2);
    CHECK(is_writable_image_path("a.exr"));
    CHECK_FALSE(is_writable_image_path("a.bmp"));
}

TEST_CASE("a picture too large for its format is told before it is made", "[image]") {
    const auto reason = [](const char *path, int width, int height, int channels = 3) {
        return why_too_large(path, width, height, channels);
    };
    CHECK(reason("a.jpg", 65535, 1).empty());
    CHECK(reason("a.JPEG", 1, 65535).empty());
    CHECK_THAT(reason("a.jpg", 65536, 1), Catch::Contains("65535"));
    CHECK_THAT(reason("a.JPEG", 1, 65536), Catch::Contains("65535"));
    for (const char *path : {"a.png", "a.hdr", "a.exr", "a.pfm"}) {
        INFO(path);
        CHECK(reason(path, 65536, 4096, 4).empty());
        CHECK(reason(path, 1, 65536).empty());
    }

    // Beyond what the program renders, but not what a caller may ask for: stb counts with int.
    for (const char *path : {"a.png", "a.hdr"}) {
        INFO(path);
        CHECK_THAT(reason(path, 65536, 65536, 4), Catch::Contains("bytes"));
    }
    CHECK_THAT(reason("a.jpg", 65535, 65535), Catch::Contains("bytes"));
}

TEST_CASE("an image error names the scene's line that asked for it", "[image]") {
    const test::ScratchFolder folder;
    const std::string path = folder.file("a.png", "no image");
    CHECK(test::error_of([&] {
              read_image(path, {"scene.xml", 12});
          }).find("scene.xml:12: " + path + ": unknown format") == 0);
}
