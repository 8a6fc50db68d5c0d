/// What control tiles tell of the variance.

#include "film/control.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

using namespace clrender;

namespace {

/// A whole number of the lowest bits that are worth 2^lsb.
template <int count> void store(uint (&words)[count][4], int channel, double value, int lsb) {
    double rest = std::ldexp(std::abs(value), -lsb);
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

void store_weight(uint (&words)[2], double weight, int lsb) {
    const auto units = static_cast<std::uint64_t>(std::ldexp(weight, -lsb));
    words[0] = static_cast<uint>(units);
    words[1] = static_cast<uint>(units >> 32U);
}

/// A rendering with `samples` samples of this mean and a variance about `centre`.
MeasuredPixel rendering(double samples, const double (&means)[3], double centre, double variance) {
    MeasuredPixel pixel{};
    for (int c = 0; c < 3; ++c) {
        store(pixel.sums.colour, c, samples * means[c], CLR_COLOUR_LSB);
        store(pixel.moments.first, c, samples * centre, CLR_FIRST_LSB);
        store(pixel.moments.second, c, samples * (centre * centre + variance), CLR_SECOND_LSB);
    }
    store_weight(pixel.sums.weight, samples, CLR_WEIGHT_LSB);
    store_weight(pixel.moments.weight, samples, CLR_SQUARE_WEIGHT_LSB);
    return pixel;
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
    const ControlLayout pixels{1024, 1024, 1, 0};
    CHECK(choose_control_group(pixels) >= 99);
}

TEST_CASE("the factor is that of the differences over what scatter makes expect") {
    const ControlLayout layout{256, 128, 8, 2};
    std::vector<ControlPixel> pixels(layout.pixels());
    std::mt19937 random(2);
    std::normal_distribution<double> gauss;
    constexpr double truth = 0.3, variance = 0.01, samples = 64, centre = 0.5;
    for (ControlPixel &pixel : pixels)
        for (MeasuredPixel &half : pixel.rendering) {
            double means[3];
            for (double &mean : means)
                mean = centre + std::sqrt(variance / samples * truth) * gauss(random);
            half = rendering(samples, means, centre, variance * (samples - 1) / samples);
        }
    const std::vector<double> means(3 * pixels.size(), centre);
    const Image image = grey(256, 128, 0.5f), layer = grey(256, 128, 1e-4f);
    const VarianceFactor factor = variance_factor({layout, pixels, means, 0}, image, layer);
    CHECK(factor.value == Approx(truth).epsilon(0.05));
    CHECK(factor.error > 0.0015);
    CHECK(factor.error < 0.0025);
    const std::vector<ControlPixel> nothing(pixels.size());
    CHECK(variance_factor({layout, nothing, means, 0}, image, layer).value == 1);
}

TEST_CASE("the relative variance is that of relMSE, and one bright pixel does not hide") {
    Image image = grey(8, 8, 0.5f);
    Image variance = grey(8, 8, 0.0005f);
    CHECK(mean_relative_variance(image, variance) == Approx(0.0005 / 0.26));
    image.f32[3 * 27 + 1] = 100;
    variance.f32[3 * 27 + 1] = 5000;
    const double others = 3 * 64 - 1;
    CHECK(mean_relative_variance(image, variance) ==
          Approx((others * 0.0005 + 5000) / 0.26 / (others + 1)));

    // Of a clamped pixel nothing is known.
    const float unknown = std::numeric_limits<float>::infinity();
    variance.f32[3 * 27 + 1] = unknown;
    CHECK(mean_relative_variance(image, variance) == Approx(0.0005 / 0.26));
    variance.f32.assign(variance.f32.size(), unknown);
    CHECK(mean_relative_variance(image, variance) == unknown);
}
