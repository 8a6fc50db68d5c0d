#include "files.h"

#include "cli/compare.h"
#include "film/metrics.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace clrender;

namespace {

Image constant(int width, int height, int channels, float value) {
    Image image;
    image.width = width;
    image.height = height;
    image.channels = channels;
    image.f32.assign(static_cast<std::size_t>(width * height * channels), value);
    return image;
}

} // namespace

TEST_CASE("metrics of two constant images", "[metrics]") {
    const ImageDifference d =
        compare_images(constant(8, 4, 3, 0.75F), constant(8, 4, 3, 0.5F), "a");
    CHECK(d.mse == Approx(0.0625));
    CHECK(d.rel_mse == Approx(0.0625 / 0.26));
    CHECK(d.rel_mse_trimmed == Approx(0.0625 / 0.26));
    CHECK(d.bias == Approx(0.25));
    CHECK(d.largest == Approx(0.25));
}

TEST_CASE("one wrong pixel in a thousand is found, and trimmed", "[metrics]") {
    // relMSE = 3^2 / (1 + .01) / 1000 from the one pixel.
    const Image reference = constant(100, 10, 1, 1);
    Image image = reference;
    image.f32[2 * 100 + 7] = 4;
    const ImageDifference d = compare_images(image, reference, "a");
    CHECK(d.rel_mse == Approx(9 / 1.01 / 1000));
    CHECK(d.rel_mse_trimmed == 0);
    CHECK(d.largest == Approx(3));
    CHECK(d.where == std::array<int, 2>{7, 2});
}

TEST_CASE("alpha does not count, 8 bits are linear light", "[metrics]") {
    Image a = constant(2, 2, 4, 1);
    a.f32[3] = 0;
    Image white;
    white.width = white.height = 2;
    white.channels = 3;
    white.type = PixelType::u8;
    white.u8.assign(12, 255);
    CHECK(compare_images(a, white, "a").mse == 0);
    white.u8.assign(12, 188); // half the light of white
    CHECK(compare_images(white, constant(2, 2, 3, 0.5F), "a").largest < 0.005);
}

TEST_CASE("NaN is counted, not averaged", "[metrics]") {
    Image a = constant(4, 1, 1, 1);
    a.f32[2] = std::numeric_limits<float>::quiet_NaN();
    const ImageDifference d = compare_images(a, constant(4, 1, 1, 1), "a");
    CHECK(d.nonfinite == 1);
    CHECK(d.mse == 0);
}

TEST_CASE("compare's exit codes", "[metrics]") {
    const test::ScratchFolder folder;
    write_image(folder.path("a.pfm"), constant(4, 4, 3, 0.5F));
    write_image(folder.path("b.pfm"), constant(4, 4, 3, 0.6F));
    write_image(folder.path("small.pfm"), constant(2, 4, 3, 0.5F));
    CHECK(compare_command(folder.path("a.pfm"), folder.path("a.pfm")) == 0);
    CHECK(compare_command(folder.path("a.pfm"), folder.path("b.pfm")) == 1);
    CHECK(compare_command(folder.path("a.pfm"), folder.path("b.pfm"), 0.1) == 0);
    CHECK_THROWS_AS(compare_command(folder.path("a.pfm"), folder.path("small.pfm")), InputError);
    CHECK_THROWS_AS(compare_command(folder.path("a.pfm"), folder.path("none.pfm")), InputError);
}
