/// The film's exact sums against integers of 128 bits and against what the samples are known to add
/// up to.

#include "cl_test_device.h"
#include "config/kernel_config.h"
#include "film/film_sums.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

using namespace clrender;
using namespace clrender::test;

namespace {

__extension__ using Integer = __int128;

constexpr float highest_word = 0x1p96f;

cl::Kernel build_probe(const ClTestDevice &device, const char *name) {
    KernelConfig config;
    config.LANES = 8;
    config.VARIANCE = 1;
    return {device.build("probes/film_probes.cl", config.build_options()), name};
}

struct Total {
    std::vector<cl_uint> words;
    cl_uint clamped = 0;

    [[nodiscard]] Integer value(std::size_t channel) const {
        Integer sum = 0;
        for (std::size_t i = CLR_COLOUR_WORDS; i-- > 0;)
            sum = static_cast<Integer>(static_cast<unsigned __int128>(sum) << 32U |
                                       words[4 * i + channel]);
        return sum;
    }
};

Total add_up(const ClTestDevice &device, const std::vector<float> &values) {
    cl::Kernel kernel = build_probe(device, "probe_film_integers");
    const std::vector<cl_uint> zeros(4 * CLR_COLOUR_WORDS, 0);
    const cl::Buffer total = device.upload<cl_uint>(zeros);
    const cl::Buffer clamped = device.upload<cl_uint>(std::span(zeros).first(1));
    const cl::Buffer in = device.upload<float>(values);
    kernel.setArg(0, in);
    kernel.setArg(1, static_cast<cl_uint>(values.size()));
    kernel.setArg(2, total);
    kernel.setArg(3, clamped);
    device.run(kernel, 1, 1);
    return {device.download<cl_uint>(total, zeros.size()),
            device.download<cl_uint>(clamped, 1).front()};
}

/// What is added for a value: its multiple of the lowest bit, cut off towards zero.
Integer integer_of(float value) {
    return static_cast<Integer>(static_cast<long double>(value) * highest_word);
}

/// `exponent`: of the film's unit.
FilmPixel add_pixel_samples(const ClTestDevice &device, cl_uint samples, float first, float base,
                            float step, int exponent = 0) {
    cl::Kernel kernel = build_probe(device, "probe_film_pixel");
    FrameData frame{};
    frame.width = frame.height = 1;
    frame.film_exponent = exponent;
    const FilmPixel nothing{};
    const cl::Buffer film = device.upload<FilmPixel>({&nothing, 1});
    const cl::Buffer frames = device.upload<FrameData>({&frame, 1});
    kernel.setArg(0, frames);
    kernel.setArg(1, film);
    kernel.setArg(2, samples);
    kernel.setArg(3, first);
    kernel.setArg(4, base);
    kernel.setArg(5, step);
    device.run(kernel, 1, 1);
    return device.download<FilmPixel>(film, 1).front();
}

} // namespace

TEST_CASE("values are added to the film as integers, exactly and in any order") {
    const ClTestDevice device;
    std::vector<float> values = {0.0f,
                                 -0.0f,
                                 1.0f,
                                 -1.0f,
                                 7.999999f,
                                 -7.999999f,
                                 0x1p-96f,
                                 -0x1p-96f,
                                 0x1.8p-96f,
                                 -0x1.8p-96f,
                                 0x1p-97f,
                                 0x1.fffffep-33f,
                                 -0x1.fffffep-65f,
                                 0x1.fffffep-1f};
    std::mt19937 random(3);
    std::uniform_real_distribution<float> size(-110, 3), sign(-1, 1);
    for (int i = 0; i < 2000; ++i)
        values.push_back(std::copysign(std::exp2(size(random)), sign(random)));
    Integer expected = 0;
    for (const float value : values)
        expected += integer_of(value);
    const Total total = add_up(device, values);
    for (std::size_t channel = 0; channel < 4; ++channel)
        CHECK((total.value(channel) == expected));
    CHECK(total.clamped == 0);
    std::shuffle(values.begin(), values.end(), random);
    CHECK(add_up(device, values).words == total.words);
    CHECK((add_up(device, {-0x1p-96f}).value(0) == -1));
}

TEST_CASE("values that the film cannot hold are clamped and counted") {
    const ClTestDevice device;
    constexpr float infinity = std::numeric_limits<float>::infinity();
    const Integer limit = integer_of(CLR_FILM_LIMIT);
    for (const float value :
         {8.000001f, 1e30f, infinity, std::numeric_limits<float>::quiet_NaN()}) {
        const Total total = add_up(device, {value, 1.0f});
        INFO(value);
        CHECK((total.value(0) == limit + integer_of(1)));
        CHECK(total.clamped == 1);
    }
    const Total negative = add_up(device, {-infinity, 1.0f});
    CHECK((negative.value(2) == integer_of(1) - limit));
    CHECK(negative.clamped == 1);
}

TEST_CASE("constants over 2^26 samples add up to 1e-6, and have no variance") {
    const ClTestDevice device;
    constexpr cl_uint samples = 1U << 26U;
    for (const float value : {1.0f, 0.1f}) {
        const FilmPixel pixel = add_pixel_samples(device, samples, value, value, 0);
        const FilmUnits units(0);
        const PixelSums sums(pixel, units);
        const double mean = sums.colour(0) / sums.weight();
        CHECK(sums.weight() == samples);
        CHECK(pixel.samples == samples);
        CHECK(pixel.clamped == 0);
        CAPTURE(value, mean);
        CHECK(std::abs(mean / double{value} - 1) <= 1e-6);
        // A device that contracts a product and a sum leaves the rounding of the product.
        for (int channel = 0; channel < 4; ++channel)
            CHECK(sums.scatter(channel) <= 0x1p-48 * samples);
    }
}

TEST_CASE("a sample of 1e6 and 2^20 of 1e-3 add up to 1e-6") {
    const ClTestDevice device;
    constexpr cl_uint samples = (1U << 20U) + 1;
    constexpr int exponent = 20;
    const FilmPixel pixel = add_pixel_samples(device, samples, 1e6f, 1e-3f, 0, exponent);
    const double expected = 1e6 + (samples - 1) * double{1e-3f};
    const FilmUnits units(exponent);
    const PixelSums sums(pixel, units);
    CAPTURE(sums.colour(1), expected);
    CHECK(std::abs(sums.colour(1) / expected - 1) <= 1e-6);
    // All of the scatter is the first sample's, in a block of 16.
    CHECK(sums.scatter(1) == Approx(1e12).epsilon(1e-5));
    CHECK(pixel.clamped == 0);
}

TEST_CASE("the scatter of samples is right to 1% from a deviation of 1e-3 of the mean on") {
    const ClTestDevice device;
    for (const cl_uint samples : {16U, 100U, 1U << 26U}) {
        for (const float step : {1e-4f, 0.03f, 0.1f}) {
            constexpr float base = 0.1f;
            const float low = base - step, high = base + step;
            const FilmPixel pixel = add_pixel_samples(device, samples, high, base, step);
            // Half of each block lies half the difference above, half below its mean.
            const double half = (double{high} - double{low}) / 2;
            double expected = 0;
            for (cl_uint b = 0; CLR_BLOCK_START(b) < samples; ++b) {
                const double n = std::min(CLR_BLOCK_START(b + 1), samples) - CLR_BLOCK_START(b);
                expected += n * n / (n - 1) * half * half;
            }
            const FilmUnits units(0);
            const double scatter = PixelSums(pixel, units).scatter(2);
            CAPTURE(samples, step, scatter, expected);
            CHECK(std::abs(scatter / expected - 1) <= 0.01);
        }
    }
}
