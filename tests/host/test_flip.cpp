/// The FLIP map against the authors' own program (flip-evaluator on PyPI).

#include "film/flip.h"

#include <catch2/catch.hpp>
#include <limits>
#include <numeric>
#include <vector>

using namespace clrender;

namespace {

template <typename Colour> Image image_of(int width, int height, Colour colour) {
    Image image;
    image.width = width;
    image.height = height;
    image.channels = 3;
    image.type = PixelType::u8;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const int value : colour(x, y))
                image.u8.push_back(static_cast<std::uint8_t>(value % 256));
    return image;
}

Image plain(int r, int g, int b) {
    return image_of(8, 8, [=](int, int) { return std::vector{r, g, b}; });
}

double mean(const Image &map) {
    return std::accumulate(map.f32.begin(), map.f32.end(), 0.0) /
           static_cast<double>(map.f32.size());
}

} // namespace

TEST_CASE("FLIP of patterns and of plain colours is that of flip-evaluator 1.7") {
    const auto pattern = [](int k) {
        return image_of(32, 24, [=](int x, int y) {
            return std::vector{x * 7 + k * 13, y * 9 + k * (x > 15 ? 40 : 0), x * y * 3 + k * 5};
        });
    };
    const Image map = flip_map(pattern(1), pattern(0));
    CHECK(mean(map) == Approx(0.3545698).epsilon(2e-5));
    CHECK(map.f32[3 * 32 + 4] == Approx(0.1248986).epsilon(2e-4));
    CHECK(map.f32[12 * 32 + 20] == Approx(0.6049937).epsilon(2e-4));
    CHECK(mean(flip_map(plain(255, 255, 255), plain(0, 0, 0))) == Approx(0.9673882).epsilon(2e-5));
    CHECK(mean(flip_map(plain(0, 0, 0), plain(200, 100, 50))) == Approx(0.9618525).epsilon(2e-5));
}

TEST_CASE("FLIP of equal pictures is 0, and it is symmetric") {
    const auto black = plain(0, 0, 0);
    const auto grey = image_of(8, 8, [](int x, int) { return std::vector{100, 100 + x, 90}; });
    for (const float value : flip_map(grey, grey).f32)
        CHECK(value == 0);
    CHECK(flip_map(grey, black).f32 == flip_map(black, grey).f32);
    Image broken = plain(0, 0, 0);
    broken.type = PixelType::f32;
    broken.u8.clear();
    broken.f32.assign(std::size_t{8} * 8 * 3, std::numeric_limits<float>::quiet_NaN());
    for (const float value : flip_map(broken, black).f32)
        CHECK(value == 0);
}
