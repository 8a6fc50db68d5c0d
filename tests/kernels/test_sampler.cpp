/// The pairs of numbers that paths are made of: their order within a pixel, and that pixels and
/// pairs know nothing of each other.

#include "cl_test_device.h"
#include "shared/config_values.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

using namespace clrender;
using namespace clrender::test;

namespace {

struct Request {
    cl_uint pixel = 0, offset = 0, samples = 1, dimension = 0, count = 1;
};

/// u and v of each, one after the other.
std::vector<float> pairs(const ClTestDevice &device, const Request &r, int lanes = 8,
                         int sampler = CLR_SAMPLER_SOBOL,
                         const char *probe = "probe_sampler_pair") {
    const std::string options =
        "-DLANES=" + std::to_string(lanes) + " -DSAMPLER=" + std::to_string(sampler);
    cl::Kernel kernel(device.build("probes/sampler_probes.cl", options), probe);
    const std::size_t count = r.count;
    const cl::Buffer out = device.allocate(2 * count * sizeof(float));
    kernel.setArg(0, out);
    kernel.setArg(1, r.pixel);
    kernel.setArg(2, r.offset);
    kernel.setArg(3, r.samples);
    kernel.setArg(4, r.dimension);
    kernel.setArg(5, r.count);
    device.run(kernel,
               (count + static_cast<std::size_t>(lanes) - 1) / static_cast<std::size_t>(lanes), 1);
    return device.download<float>(out, 2 * count);
}

/// Chi-square of points on a grid of side x side cells, in standard deviations from its mean.
double deviation_from_uniform(const std::vector<double> &us, const std::vector<double> &vs,
                              int side) {
    std::vector<double> cells(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 0.0);
    for (std::size_t i = 0; i < us.size(); ++i)
        ++cells[static_cast<std::size_t>(us[i] * side) * static_cast<std::size_t>(side) +
                static_cast<std::size_t>(vs[i] * side)];
    const double expected = static_cast<double>(us.size()) / static_cast<double>(cells.size());
    double chi2 = 0;
    for (const double n : cells)
        chi2 += (n - expected) * (n - expected) / expected;
    const double freedom = static_cast<double>(cells.size()) - 1;
    return (chi2 - freedom) / std::sqrt(2 * freedom);
}

} // namespace

TEST_CASE("samples of a pixel are a (0, m, 2)-net in every pair", "[oclgrind]") {
    const ClTestDevice device;
    const int largest = small_tests() ? 4 : 9;
    for (const cl_uint pixel : {0u, 12345u})
        for (const cl_uint dimension : {0u, 2u, 41u})
            for (int m = 1; m <= largest; m += 2)
                for (const cl_uint block : {0u, 5u}) {
                    const cl_uint n = 1u << m;
                    const auto p = pairs(device, {pixel, block * n, n, dimension, n});
                    // Every way to cut the square into 2^m equal boxes: one point in each.
                    for (int a = 0; a <= m; ++a) {
                        std::vector<int> hits(n, 0);
                        for (std::size_t i = 0; i < n; ++i) {
                            const auto column =
                                static_cast<std::size_t>(p[2 * i] * static_cast<float>(1 << a));
                            const auto row = static_cast<std::size_t>(
                                p[2 * i + 1] * static_cast<float>(1 << (m - a)));
                            ++hits.at((column << (m - a)) + row);
                        }
                        INFO("pixel " << pixel << ", dimension " << dimension << ", 2^" << m
                                      << " samples of block " << block << ", 2^" << a
                                      << " columns");
                        REQUIRE(hits == std::vector<int>(n, 1));
                    }
                }
}

TEST_CASE("pairs are the same at every width", "[oclgrind]") {
    const ClTestDevice device;
    const Request some{7, 4000000000u, 50, 12, 150};
    const auto narrow = pairs(device, some, 1);
    for (const float v : narrow)
        REQUIRE((v >= 0.0f && v < 1.0f));
    for (const int lanes : {4, 8, 16})
        CHECK(pairs(device, some, lanes) == narrow);
}

TEST_CASE("the n-th samples of all pixels fill the square evenly") {
    const ClTestDevice device;
    for (const int sampler : {CLR_SAMPLER_SOBOL, CLR_SAMPLER_INDEPENDENT})
        for (const cl_uint sample : {0u, 1u, 63u}) {
            const auto p = pairs(device, {0, sample, 1, 8, 1u << 16}, 8, sampler);
            std::vector<double> u, v;
            for (std::size_t i = 0; i < p.size(); i += 2) {
                u.push_back(p[i]);
                v.push_back(p[i + 1]);
            }
            INFO("sampler " << sampler << ", sample " << sample);
            CHECK(std::abs(deviation_from_uniform(u, v, 16)) < 5);
        }
}

TEST_CASE("numbers of different pairs, and of neighbouring pixels, do not go together") {
    const ClTestDevice device;
    // 16 samples of 4096 pixels: were the orders alike, some cells would stay empty.
    const Request first{0, 0, 16, 4, 1u << 16};
    const auto a = pairs(device, first);
    const auto other_pair = pairs(device, {0, 0, 16, 6, 1u << 16});
    const auto next_pixel = pairs(device, {1, 0, 16, 4, 1u << 16});
    for (const std::size_t mine : {0, 1})
        for (const std::size_t theirs : {CLR_SAMPLER_SOBOL, CLR_SAMPLER_INDEPENDENT}) {
            std::vector<double> x, y, z;
            for (std::size_t i = 0; i < a.size(); i += 2) {
                x.push_back(a[i + mine]);
                y.push_back(other_pair[i + theirs]);
                z.push_back(next_pixel[i + theirs]);
            }
            CHECK(std::abs(deviation_from_uniform(x, y, 16)) < 5);
            CHECK(std::abs(deviation_from_uniform(x, z, 16)) < 5);
        }
}

TEST_CASE("single numbers of a pixel's samples are independent from dimension to dimension") {
    const ClTestDevice device;
    constexpr std::size_t pixels = 1024, samples = 64;
    const auto turns = [](double u) { return std::cos(2 * M_PI * u); };
    for (const int sampler : {CLR_SAMPLER_SOBOL, CLR_SAMPLER_INDEPENDENT}) {
        const auto numbers = [&](cl_uint dimension) {
            return pairs(device, {77, 0, samples, dimension, pixels * samples}, 8, sampler,
                         "probe_sampler_two");
        };
        const auto a = numbers(4), b = numbers(6), far = numbers(4 + (3u << 8u));
        // Each with its variance for independent numbers.
        const std::vector<std::pair<std::function<double(double, double)>, double>> functions = {
            {[&](double u, double v) { return turns(u - v); }, 0.5},
            {[&](double u, double v) { return turns(u + v); }, 0.5},
            {[](double u, double v) { return u + v < 1 ? 1.0 : 0.0; }, 0.25},
            {[](double u, double v) { return u * v; }, 1.0 / 9 - 1.0 / 16}};
        for (const auto *other : {&b, &far})
            for (std::size_t f = 0; f < functions.size(); ++f) {
                const auto &[function, variance] = functions[f];
                double sum = 0, squares = 0;
                for (std::size_t p = 0; p < pixels; ++p) {
                    double mean = 0;
                    for (std::size_t i = p * samples; i < (p + 1) * samples; ++i)
                        mean += function(a[2 * i], (*other)[2 * i + 1]) / samples;
                    sum += mean / pixels;
                    squares += mean * mean / pixels;
                }
                // The variance of so many means is known to 4.4%.
                const double ratio = (squares - sum * sum) * samples / variance;
                INFO("sampler " << sampler << ", function " << f << ": " << ratio);
                CHECK(ratio > 0.8);
                CHECK(ratio < 1.2);
            }
    }
}
