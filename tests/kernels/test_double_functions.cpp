/// Small device functions in double precision.

#include "cl_test_device.h"
#include "selftest/probe_device.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <random>
#include <string>

using namespace clrender;
using namespace clrender::test;

namespace {

/// What probe_math makes of records of `in_size` numbers, `out_size` for each.
std::vector<double> run_in_double(const ClTestDevice &device, const std::vector<double> &in,
                                  std::size_t in_size, std::size_t out_size) {
    KernelConfig config = selftest::probe_config(1, CLR_FILTER_SAMPLED);
    config.DOUBLE_PRECISION = 1;
    cl::Kernel kernel(device.build("probes/selftest_probes.cl", config.build_options()),
                      "probe_math");
    return device.run_records(kernel, 1, in, in_size, out_size);
}

double size_of(long double difference) {
    return static_cast<double>(std::abs(difference));
}

} // namespace

TEST_CASE("in double precision the functions are right to a few units in the last place",
          "[oclgrind]") {
    const ClTestDevice device;
    std::mt19937 random(6);
    std::uniform_real_distribution<double> uniform;
    std::normal_distribution<double> gauss;
    const std::size_t count = small_tests() ? 50 : 20000;
    constexpr long double two_pi = 2 * std::numbers::pi_v<long double>;
    // What probe_math takes: turn; y, x; squared distance and radius; n; two densities; u1, u2.
    constexpr std::size_t in_size = 12, out_size = 16;
    std::vector<double> in;
    for (std::size_t i = 0; i < count; ++i) {
        const double distance2 = std::exp(uniform(random) * 40 - 20);
        const glm::dvec3 n =
            glm::normalize(glm::dvec3(gauss(random), gauss(random), gauss(random)));
        in.insert(in.end(),
                  {uniform(random), gauss(random), gauss(random) * (i % 2 == 0 ? 1 : 1e-4),
                   distance2, distance2 * uniform(random) * 0.99, n.x, n.y, n.z, 1, 1, 0.5, 0.5});
    }

    selftest::Worst sincos, turn, cap, frame;
    const std::vector<double> out = run_in_double(device, in, in_size, out_size);
    for (std::size_t i = 0; i < count; ++i) {
        const double *a = &in[in_size * i], *b = &out[out_size * i];
        const long double angle = two_pi * a[0];
        sincos.see(size_of(std::sin(angle) - b[0]));
        sincos.see(size_of(std::cos(angle) - b[1]));
        turn.see(size_of(
            std::atan2(static_cast<long double>(a[1]), static_cast<long double>(a[2])) / two_pi -
            b[2]));
        const long double sine2 = static_cast<long double>(a[4]) / a[3];
        cap.see(size_of(b[3] / (1 - std::sqrt(1 - sine2)) - 1));
        const glm::dvec3 n(a[5], a[6], a[7]);
        const glm::dvec3 s(b[4], b[5], b[6]), t(b[7], b[8], b[9]);
        for (const double off : {glm::dot(s, s) - 1, glm::dot(t, t) - 1, glm::dot(s, t),
                                 glm::dot(s, n), glm::dot(t, n)})
            frame.see(std::abs(off));
    }
    // Oclgrind takes sine and cosine from a library of its own.
    CHECK(sincos.value() < (small_tests() ? 1e-15 : 4e-16));
    CHECK(turn.value() < 2e-16);
    CHECK(cap.value() < 1e-14); // of d^2 - r^2, down to a hundredth
    CHECK(frame.value() < 1e-15);
}
