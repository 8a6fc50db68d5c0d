/// The film on the host: sums of parts, blocks of samples, and pictures of sums.

#include "film/film.h"
#include "film/film_blocks.h"
#include "film/film_sums.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

using namespace clrender;

namespace {

__extension__ using Integer = __int128;
__extension__ using Bits = unsigned __int128;

constexpr int channels = 4;

/// A multiple of the lowest bit, as the device stores it.
template <int count> void store(uint (&words)[count][channels], int channel, Integer value) {
    for (int i = 0; i < count; ++i)
        words[i][channel] = i < 4 ? static_cast<uint>(static_cast<Bits>(value) >> (32 * i))
                                  : (value < 0 ? ~0U : 0U);
}

void store_weight(uint (&words)[2], double weight, int lsb) {
    const auto units = static_cast<std::uint64_t>(std::ldexp(weight, -lsb));
    words[0] = static_cast<uint>(units);
    words[1] = static_cast<uint>(units >> 32U);
}

MeasuredPixel random_pixel(std::mt19937_64 &random) {
    MeasuredPixel pixel{};
    const auto number = [&] {
        return (static_cast<Integer>(random()) << 40U) - (static_cast<Integer>(random()) << 40U) +
               static_cast<Integer>(random());
    };
    for (int c = 0; c < channels; ++c) {
        store(pixel.sums.colour, c, number());
        store(pixel.moments.first, c, number());
        store(pixel.moments.second, c, std::max<Integer>(number(), 0));
    }
    for (uint *weight : {pixel.sums.weight, pixel.moments.weight}) {
        weight[0] = static_cast<uint>(random());
        weight[1] = static_cast<uint>(random() % 1000);
    }
    pixel.sums.samples = static_cast<uint>(random() % 1000);
    return pixel;
}

void add(MeasuredPixel &sum, const MeasuredPixel &part) {
    add_pixel(sum.sums, part.sums);
    add_moments(sum.moments, part.moments);
}

bool same(const MeasuredPixel &a, const MeasuredPixel &b) {
    return std::memcmp(&a, &b, sizeof(MeasuredPixel)) == 0;
}

/// A multiple of the lowest bit that is worth 2^lsb.
Integer units_of(double value, int lsb) {
    return static_cast<Integer>(std::ldexp(static_cast<long double>(value), -lsb));
}

/// A pixel of `samples` samples of weight `w`, half of them `value` + `step` and half `value` -
/// `step`, all numbers with few bits.
MeasuredPixel grey(double value, double step, uint samples, double w = 1) {
    MeasuredPixel pixel{};
    for (int c = 0; c < channels; ++c) {
        store(pixel.sums.colour, c, units_of(samples * w * value, CLR_COLOUR_LSB));
        store(pixel.moments.first, c, units_of(samples * w * w * value, CLR_FIRST_LSB));
        store(pixel.moments.second, c,
              units_of(samples * w * w * (value * value + step * step), CLR_SECOND_LSB));
    }
    store_weight(pixel.sums.weight, samples * w, CLR_WEIGHT_LSB);
    store_weight(pixel.moments.weight, samples * w * w, CLR_SQUARE_WEIGHT_LSB);
    pixel.sums.samples = samples;
    return pixel;
}

Film film_of(const std::vector<MeasuredPixel> &pixels) {
    Film film;
    film.width = static_cast<int>(pixels.size());
    film.height = 1;
    for (const MeasuredPixel &pixel : pixels) {
        film.pixels.push_back(pixel.sums);
        film.moments.push_back(pixel.moments);
    }
    return film;
}

} // namespace

TEST_CASE("blocks of samples begin at 0, 16, 32, 64 and then every 64") {
    std::vector<int> starts;
    for (int b = 0; b < 7; ++b)
        starts.push_back(CLR_BLOCK_START(b));
    CHECK(starts == std::vector{0, 16, 32, 64, 128, 192, 256});
    for (const auto &[samples, blocks] : {std::pair{1, 1},
                                          {16, 1},
                                          {17, 2},
                                          {32, 2},
                                          {33, 3},
                                          {64, 3},
                                          {65, 4},
                                          {128, 4},
                                          {129, 5},
                                          {2147483647, 33554434}}) {
        INFO(samples);
        CHECK(blocks_of(samples) == blocks);
    }
    CHECK(whole_blocks(33) == 64);
    CHECK(whole_blocks(64) == 64);
    CHECK(whole_blocks(65) == 128);
}

TEST_CASE("sums of parts are the same bits in any order") {
    std::mt19937_64 random(5);
    std::vector<MeasuredPixel> parts;
    for (int i = 0; i < 20; ++i)
        parts.push_back(random_pixel(random));
    MeasuredPixel one_by_one{};
    for (const MeasuredPixel &part : parts)
        add(one_by_one, part);
    std::shuffle(parts.begin(), parts.end(), random);
    MeasuredPixel halves[2]{};
    for (std::size_t i = 0; i < parts.size(); ++i)
        add(halves[i % 3 == 0 ? 0 : 1], parts[i]);
    add(halves[0], halves[1]);
    CHECK(same(halves[0], one_by_one));
    CHECK_FALSE(same(halves[1], one_by_one));
}

TEST_CASE("words in two's complement are the numbers that they stand for") {
    MeasuredPixel pixel{};
    const FilmUnits units(5);
    const PixelSums sums(pixel.sums, units);
    const PixelMoments moments(pixel.moments, units);
    for (const Integer value :
         {Integer{0}, Integer{1}, Integer{-1}, Integer{1} << 100U, -(Integer{1} << 100U),
          Integer{-12345} << 57U, (Integer{1} << 64U) - 1, -(Integer{1} << 64U),
          Integer{-1} << 32U}) {
        store(pixel.sums.colour, 1, value);
        store(pixel.sums.colour, 3, value);
        store(pixel.moments.second, 1, value);
        const auto number = static_cast<double>(value);
        CHECK(sums.colour(1) == std::ldexp(number, CLR_COLOUR_LSB + 5));
        CHECK(sums.colour(3) == std::ldexp(number, CLR_COLOUR_LSB));
        CHECK(moments.scatter(1, 0) == std::max(std::ldexp(number, CLR_SECOND_LSB + 10), 0.0));
    }
}

TEST_CASE("mean and variance of a pixel follow from its sums") {
    Film film = film_of({grey(0.25, 0.5, 64), grey(3, 2, 16), grey(3, 2, 16, 0.5)});
    const Image mean = film_mean(film, PixelFormat::rgba);
    const Image variance = film_variance(film, PixelFormat::rgba);
    for (std::size_t c = 0; c < 4; ++c) {
        CHECK(mean.f32[c] == 0.25f);
        CHECK(mean.f32[4 + c] == 3.0f);
        CHECK(variance.f32[c] == Approx(0.25 / 63));
        CHECK(variance.f32[4 + c] == Approx(4.0 / 15));
        CHECK(variance.f32[8 + c] == Approx(4.0 / 15));
    }
    film.pixels[1].samples = 1;
    film.pixels[2].clamped = 1;
    CHECK(std::isinf(film_variance(film, PixelFormat::rgb).f32[3]));
    CHECK(std::isinf(film_variance(film, PixelFormat::rgb).f32[6]));
}

TEST_CASE("what two tiles add to a pixel varies about the mean of both") {
    // Each has no variance of its own, and they differ: how they share the pixel is noise.
    MeasuredPixel pixel = grey(1, 0, 48, 0.5);
    add(pixel, grey(5, 0, 16, 0.5));
    const Film film = film_of({pixel});
    CHECK(film_mean(film, PixelFormat::rgb).f32[0] == 2.0f);
    // 48 of distance 1 and 16 of distance 3, a mean of 3; over 64 and one less.
    CHECK(film_variance(film, PixelFormat::rgb).f32[0] == Approx(3.0 / 63));
}

TEST_CASE("a deviation of a millionth of the mean is seen") {
    constexpr double value = 1 + 0x1p-10, step = 0x1p-20;
    const Film film = film_of({grey(value, step, 1U << 20U)});
    CHECK(film_variance(film, PixelFormat::rgb).f32[0] == Approx(std::ldexp(step * step, -20)));
}
