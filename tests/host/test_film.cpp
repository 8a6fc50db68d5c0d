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

FilmPixel random_pixel(std::mt19937_64 &random) {
    FilmPixel pixel{};
    const auto number = [&] {
        return (static_cast<Integer>(random()) << 40U) - (static_cast<Integer>(random()) << 40U) +
               static_cast<Integer>(random());
    };
    for (int c = 0; c < channels; ++c) {
        store(pixel.colour, c, number());
        store(pixel.scatter, c, std::max<Integer>(number(), 0));
    }
    pixel.weight[0] = static_cast<uint>(random());
    pixel.weight[1] = static_cast<uint>(random() % 1000);
    pixel.samples = static_cast<uint>(random() % 1000);
    return pixel;
}

bool same(const FilmPixel &a, const FilmPixel &b) {
    return std::memcmp(&a, &b, sizeof(FilmPixel)) == 0;
}

/// A pixel of `samples` samples of this grey, with a variance of theirs.
FilmPixel grey(double value, double variance, uint samples) {
    FilmPixel pixel{};
    for (int c = 0; c < channels; ++c) {
        store(pixel.colour, c,
              static_cast<Integer>(
                  std::ldexp(static_cast<long double>(value) * samples, -CLR_COLOUR_LSB)));
        store(pixel.scatter, c,
              static_cast<Integer>(
                  std::ldexp(static_cast<long double>(variance) * samples, -CLR_SCATTER_LSB)));
    }
    const auto weight = std::uint64_t{samples} << static_cast<unsigned>(-CLR_WEIGHT_LSB);
    pixel.weight[0] = static_cast<uint>(weight);
    pixel.weight[1] = static_cast<uint>(weight >> 32U);
    pixel.samples = samples;
    return pixel;
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
    std::vector<FilmPixel> parts;
    for (int i = 0; i < 20; ++i)
        parts.push_back(random_pixel(random));
    FilmPixel one_by_one{};
    for (const FilmPixel &part : parts)
        add_pixel(one_by_one, part);
    std::shuffle(parts.begin(), parts.end(), random);
    FilmPixel halves[2]{};
    for (std::size_t i = 0; i < parts.size(); ++i)
        add_pixel(halves[i % 3 == 0 ? 0 : 1], parts[i]);
    add_pixel(halves[0], halves[1]);
    CHECK(same(halves[0], one_by_one));
    CHECK_FALSE(same(halves[1], one_by_one));
}

TEST_CASE("words in two's complement are the numbers that they stand for") {
    FilmPixel pixel{};
    const FilmUnits units(5);
    const PixelSums sums(pixel, units);
    for (const Integer value :
         {Integer{0}, Integer{1}, Integer{-1}, Integer{1} << 100U, -(Integer{1} << 100U),
          Integer{-12345} << 57U, (Integer{1} << 64U) - 1, -(Integer{1} << 64U),
          Integer{-1} << 32U}) {
        store(pixel.colour, 1, value);
        store(pixel.colour, 3, value);
        store(pixel.scatter, 1, value);
        const auto number = static_cast<double>(value);
        CHECK(sums.colour(1) == std::ldexp(number, CLR_COLOUR_LSB + 5));
        CHECK(sums.colour(3) == std::ldexp(number, CLR_COLOUR_LSB));
        CHECK(sums.scatter(1) == std::ldexp(number, CLR_SCATTER_LSB + 10));
    }
}

TEST_CASE("mean and variance of a pixel follow from its sums") {
    Film film;
    film.width = 2;
    film.height = 1;
    film.pixels = {grey(0.25, 0.5, 64), grey(3, 2, 16)};
    const Image mean = film_mean(film, PixelFormat::rgba);
    const Image variance = film_variance(film, PixelFormat::rgba);
    for (std::size_t c = 0; c < 4; ++c) {
        CHECK(mean.f32[c] == 0.25f);
        CHECK(mean.f32[4 + c] == 3.0f);
        CHECK(variance.f32[c] == Approx(0.5 / 64));
        CHECK(variance.f32[4 + c] == Approx(2.0 / 16));
    }
    film.pixels[1].samples = 1;
    CHECK(std::isinf(film_variance(film, PixelFormat::rgb).f32[3]));
}
