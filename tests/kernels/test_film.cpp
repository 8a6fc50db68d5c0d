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

/// A pixel with samples as probe_film_pixel makes them.
struct PixelSamples {
    cl_uint count = 0;
    float first = 0, base = 0, step = 0, other = 0;
    int exponent = 0; ///< of the film's unit
};

MeasuredPixel pixel_with(const ClTestDevice &device, const PixelSamples &samples) {
    cl::Kernel kernel = build_probe(device, "probe_film_pixel");
    FrameData frame{};
    frame.width = frame.height = 1;
    frame.film_exponent = samples.exponent;
    const MeasuredPixel nothing{};
    const cl::Buffer film = device.upload<MeasuredPixel>({&nothing, 1});
    const cl::Buffer frames = device.upload<FrameData>({&frame, 1});
    kernel.setArg(0, frames);
    kernel.setArg(1, film);
    kernel.setArg(2, samples.count);
    kernel.setArg(3, samples.first);
    kernel.setArg(4, samples.base);
    kernel.setArg(5, samples.step);
    kernel.setArg(6, samples.other);
    device.run(kernel, 1, 1);
    return device.download<MeasuredPixel>(film, 1).front();
}

/// The scatter about the mean of what pixel_with() is given, in double precision.
double expected_scatter(const PixelSamples &samples) {
    double count = 0, sum = 0, squares = 0; // of distances from `base`
    const auto add = [&](float value, double times) {
        const double distance = double{value} - double{samples.base};
        count += times;
        sum += times * distance;
        squares += times * distance * distance;
    };
    add(samples.first, 1);
    for (cl_uint b = 0; CLR_BLOCK_START(b) < samples.count; ++b) {
        const cl_uint start = CLR_BLOCK_START(b);
        const cl_uint size = std::min(CLR_BLOCK_START(b + 1), samples.count) - start;
        const float middle = b % 2 == 0 ? samples.base : samples.other;
        add(middle + samples.step, (size + 1) / 2 - (start == 0 ? 1 : 0));
        add(middle - samples.step, size / 2);
    }
    return squares - sum * sum / count;
}

double scatter_of(const MeasuredPixel &pixel, int channel, int exponent = 0) {
    const FilmUnits units(exponent);
    const PixelSums sums(pixel.sums, units);
    return PixelMoments(pixel.moments, units).scatter(channel, sums.mean(channel));
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
        const MeasuredPixel pixel = pixel_with(device, {samples, value, value, 0, value});
        const FilmUnits units(0);
        const PixelSums sums(pixel.sums, units);
        CHECK(sums.weight() == samples);
        CHECK(sums.samples() == samples);
        CHECK(pixel.sums.clamped == 0);
        CAPTURE(value, sums.mean(0));
        CHECK(std::abs(sums.mean(0) / double{value} - 1) <= 1e-6);
        // The mean is off by the rounding of a block's sum.
        for (int channel = 0; channel < 4; ++channel)
            CHECK(scatter_of(pixel, channel) <= 0x1p-46 * samples);
    }
}

TEST_CASE("a sample of 1e6 and 2^20 of 1e-3 add up to 1e-6") {
    const ClTestDevice device;
    constexpr cl_uint samples = (1U << 20U) + 1;
    constexpr int exponent = 20;
    const MeasuredPixel pixel = pixel_with(device, {samples, 1e6f, 1e-3f, 0, 1e-3f, exponent});
    const double expected = 1e6 + (samples - 1) * double{1e-3f};
    const FilmUnits units(exponent);
    const PixelSums sums(pixel.sums, units);
    CAPTURE(sums.colour(1), expected);
    CHECK(std::abs(sums.colour(1) / expected - 1) <= 1e-6);
    CHECK(scatter_of(pixel, 1, exponent) == Approx(1e12).epsilon(1e-5));
    CHECK(pixel.sums.clamped == 0);
}

TEST_CASE("the scatter of samples is right to 1% from a deviation of 1e-3 of the mean on") {
    const ClTestDevice device;
    for (const cl_uint count : {16U, 100U, 1U << 26U}) {
        for (const float step : {1e-4f, 0.03f, 0.1f}) {
            constexpr float base = 0.1f;
            const PixelSamples samples{count, base + step, base, step, base};
            const double scatter = scatter_of(pixel_with(device, samples), 2);
            const double expected = expected_scatter(samples);
            CAPTURE(count, step, scatter, expected);
            CHECK(std::abs(scatter / expected - 1) <= 0.01);
        }
    }
}

TEST_CASE("samples scatter about the mean of all blocks") {
    // As where two tiles share a pixel at an edge: each block alone has next to no scatter.
    const ClTestDevice device;
    for (const cl_uint count : {32U, 1000U}) {
        for (const float other : {0.1002f, 0.2f, 1e4f}) {
            const PixelSamples samples{count, 0.1f, 0.1f, 1e-6f, other};
            const double scatter = scatter_of(pixel_with(device, samples), 0);
            const double expected = expected_scatter(samples);
            CAPTURE(count, other, scatter, expected);
            CHECK(std::abs(scatter / expected - 1) <= 0.01);
        }
    }
}
