/// The functions of kernels/math.clh against those of the C++ library in long double.

#include "cl_test_device.h"
#include "config/kernel_config.h"
#include "selftest/check.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace clrender;
using namespace clrender::test;
using selftest::Worst;

namespace {

constexpr std::size_t size = 4; ///< arguments, and results, of a record of probe_functions

/// Arguments: the ends of what each function is defined for, then random ones.
template <class Real> std::vector<Real> arguments(std::size_t count) {
    constexpr bool is_double = sizeof(Real) == sizeof(double);
    const double lowest = is_double ? -708 : -87, highest = is_double ? 709 : 88;
    selftest::Random random(5);
    std::vector<double> in{lowest,   std::numeric_limits<Real>::min(),
                           0,        -1 + 0x1p-24,
                           highest,  std::numeric_limits<Real>::max(),
                           1e30,     1 - 0x1p-24,
                           0,        1,
                           1,        0,
                           -0x1p-24, std::nextafter(Real{1}, Real{0}),
                           1e-20,    0x1p-24};
    while (in.size() < count * size) {
        const bool narrow = in.size() / size % 2 == 0;
        in.push_back(narrow ? random.between(-1, 1) : random.between(lowest, highest));
        in.push_back(std::exp(narrow ? random.between(-1, 1) : random.between(lowest, highest)));
        in.push_back(narrow ? random.between(0, 3) : std::exp(random.between(-20, 20)));
        const double gap = std::exp(random.between(std::log(0x1p-24), 0));
        in.push_back(std::copysign(narrow ? gap : 1 - gap, random.between(-1, 1)));
    }
    return {in.begin(), in.end()};
}

template <class Real> std::vector<Real> run(int lanes, const std::vector<Real> &in) {
    static const ClTestDevice *const device = new ClTestDevice;
    KernelConfig config;
    config.LANES = lanes;
    config.DOUBLE_PRECISION = sizeof(Real) == sizeof(double) ? 1 : 0;
    cl::Kernel kernel(device->build("probes/math_probes.cl", config.build_options()),
                      "probe_functions");
    return device->run_records(kernel, lanes, in, size, size);
}

double relative(long double found, long double exact) {
    return static_cast<double>(std::abs(found / exact - 1));
}

/// e^(x^2) erfc(x), beyond the reach of erfc by the continued fraction (DLMF 7.9.1).
long double scaled_erfc(long double x) {
    if (x < 20)
        return std::exp(x * x) * std::erfc(x);
    long double fraction = x;
    for (int k = 20; k > 0; --k)
        fraction = x + k / 2.0L / fraction;
    return std::numbers::inv_sqrtpi_v<long double> / fraction;
}

/// How far x is from the inverse of the error function at y, relative to x or to .01: the residual
/// over the derivative, from erfc so that nothing cancels next to 1.
double inverse_error(long double x, long double y) {
    if (y == 0)
        return static_cast<double>(std::abs(x));
    const long double size = std::abs(x), wanted = std::abs(y);
    const long double residual =
        wanted < 0.5L ? std::erf(size) - wanted : (1 - wanted) - std::erfc(size);
    const long double slope = 2 * std::numbers::inv_sqrtpi_v<long double> * std::exp(-size * size);
    return static_cast<double>(std::abs(residual / slope) / std::max(size, 0.01L)) +
           (x * y > 0 ? 0 : 1);
}

template <class Real> void check(int lanes, const std::array<double, size> &bars) {
    const std::vector<Real> in = arguments<Real>(small_tests() ? 64 : 100000);
    const std::vector<Real> out = run(lanes, in);
    Worst exponential, logarithm, erfc, inverse;
    for (std::size_t i = 0; i < in.size(); i += size) {
        exponential.see(relative(out[i], std::exp(static_cast<long double>(in[i]))));
        const long double log = std::log(static_cast<long double>(in[i + 1]));
        logarithm.see(
            static_cast<double>(std::abs(out[i + 1] - log) / std::max(1.0L, std::abs(log))));
        erfc.see(relative(out[i + 2], scaled_erfc(in[i + 2])));
        inverse.see(inverse_error(out[i + 3], in[i + 3]));
    }
    INFO(lanes << " lanes, " << sizeof(Real) << " bytes: " << exponential.value() << ' '
               << logarithm.value() << ' ' << erfc.value() << ' ' << inverse.value());
    CHECK(exponential.value() < bars[0]);
    CHECK(logarithm.value() < bars[1]);
    CHECK(erfc.value() < bars[2]);
    CHECK(inverse.value() < bars[3]);
}

} // namespace

TEST_CASE("exponential, logarithm and error functions keep their stated errors", "[oclgrind]") {
    for (const int lanes : {1, 4, 8, 16})
        check<float>(lanes, {1.5e-7, 1.2e-7, 5e-7, 4e-7});
    check<double>(1, {4e-16, 3e-16, 3e-14, 3e-12});
}

TEST_CASE("exponential, logarithm and error functions give the same bits at every width",
          "[oclgrind]") {
    const std::vector<float> in = arguments<float>(small_tests() ? 64 : 10000);
    const std::vector<float> narrow = run(1, in);
    for (const int lanes : {4, 8, 16})
        CHECK(run(lanes, in) == narrow);
}

TEST_CASE("exponential and logarithm stay finite outside their ranges", "[oclgrind]") {
    const float infinity = std::numeric_limits<float>::infinity();
    const std::vector<float> out =
        run<float>(4, {-infinity, 0, 0, 1, infinity, 0, infinity, -1, -100, 0, 0, 2, 100, 0, 0, 2});
    CHECK(out[0] == 0);
    CHECK(out[8] == 0);
    for (const std::size_t i : {4U, 12U})
        CHECK(std::isfinite(out[i]));
    CHECK(out[1] < -80);
    CHECK(std::isfinite(out[1]));
    CHECK(out[6] == 0);
    CHECK(out[3] == -out[7]);
    CHECK(std::isfinite(out[3]));
}
