/// What control tiles tell of the variance.

#include "film/control.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>

using namespace clrender;

namespace {

/// A whole number of the lowest bits that are worth 2^lsb.
template <int count> void store(uint (&words)[count][4], int channel, double value, int lsb) {
    const double size = std::ldexp(std::abs(value), -lsb);
    double rest = size;
    std::uint64_t carry = value < 0 ? 1 : 0;
    for (int i = 0; i < count; ++i) {
        const double above = std::floor(std::ldexp(rest, -32));
        const auto word = static_cast<uint>(rest - std::ldexp(above, 32));
        carry += value < 0 ? ~word : word;
        words[i][channel] = static_cast<uint>(carry);
        carry >>= 32U;
        rest = above;
    }
}

Image grey(int width, int height, float value) {
    Image image;
    image.width = width;
    image.height = height;
    image.channels = 3;
    image.f32.assign(static_cast<std::size_t>(width * height * 3), value);
    return image;
}

} // namespace

TEST_CASE("each group of tiles has one control tile, at places that change") {
    constexpr uint size = 7, tiles = 100;
    std::vector<int> hits(size, 0);
    for (uint group = 0; group * size < tiles; ++group) {
        const uint tile = clr_control_tile(group, size, tiles);
        CHECK(tile / size == group);
        CHECK(tile < tiles);
        ++hits[tile % size];
    }
    CHECK(std::ranges::count(hits, 0) <= 2);
}

TEST_CASE("small pictures have many control tiles, large ones a hundredth") {
    const ControlLayout small{48, 36, 8, 0};
    CHECK(choose_control_group(small) == 1);
    const ControlLayout large{1920, 1080, 8, 0};
    CHECK(choose_control_group(large) >= 99);
    const ControlLayout pixels{512, 512, 1, 0};
    CHECK(choose_control_group(pixels) >= 99);
}

TEST_CASE("the factor is that of the differences over what scatter makes expect") {
    const ControlLayout layout{256, 128, 8, 2};
    std::vector<ControlPixel> pixels(layout.count() * 64);
    std::mt19937 random(2);
    std::normal_distribution<double> gauss;
    constexpr double truth = 0.3, variance = 0.01, samples = 64;
    for (ControlPixel &pixel : pixels)
        for (int c = 0; c < 3; ++c) {
            store(pixel.scatter, c, 2 * samples * variance, CLR_SCATTER_LSB);
            store(pixel.difference, c, std::sqrt(2 * samples * variance * truth) * gauss(random),
                  CLR_DIFFERENCE_LSB);
        }
    const VarianceFactor factor = variance_factor(layout, pixels, grey(256, 128, 0.5f), 0);
    CHECK(factor.value == Approx(truth).epsilon(0.05));
    CHECK(factor.error > 0.0015);
    CHECK(factor.error < 0.0025);
    const std::vector<ControlPixel> nothing(pixels.size());
    CHECK(variance_factor(layout, nothing, grey(256, 128, 0.5f), 0).value == 1);
}

TEST_CASE("the relative variance is that of relMSE, and one bright pixel does not hide") {
    Image image = grey(8, 8, 0.5f);
    Image variance = grey(8, 8, 0.01f);
    CHECK(mean_relative_variance(image, variance) == Approx(0.01 / 0.26));
    image.f32[3 * 27 + 1] = 100;
    variance.f32[3 * 27 + 1] = 5000;
    const double others = 3 * 64 - 1;
    CHECK(mean_relative_variance(image, variance) ==
          Approx((others * 0.01 + 5000) / 0.26 / (others + 1)));
}
