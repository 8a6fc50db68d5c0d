/// kernels/microfacet.clh against an oracle in double precision, and its samples against their
/// density.

#include "cl_test_device.h"
#include "config/kernel_config.h"
#include "microfacet_oracle.h"
#include "selftest/check.h"
#include "sphere_cells.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numeric>

using namespace clrender;
using namespace clrender::test;
using selftest::Worst;

namespace {

constexpr std::size_t in_size = 11, out_size = 7; ///< of probe_microfacets

/// The kernel for a width and a precision, compiled once.
cl::Kernel kernel_for(const ClTestDevice &device, int lanes, bool is_double) {
    static std::map<int, cl::Program> *const programs = new std::map<int, cl::Program>;
    const auto [found, is_new] = programs->try_emplace(is_double ? 0 : lanes);
    if (is_new) {
        KernelConfig config;
        config.LANES = lanes;
        config.DOUBLE_PRECISION = is_double ? 1 : 0;
        config.HAS_GGX = config.HAS_BECKMANN = 1;
        found->second = device.build("probes/microfacet_probes.cl", config.build_options());
    }
    return {found->second, "probe_microfacets"};
}

template <class Real> std::vector<Real> run(int lanes, const std::vector<Real> &in) {
    static const ClTestDevice *const device = new ClTestDevice;
    cl::Kernel kernel = kernel_for(*device, lanes, sizeof(Real) == sizeof(double));
    return device->run_records(kernel, lanes, in, in_size, out_size);
}

/// A record's numbers as the oracle takes them.
struct Case {
    glm::dvec3 wi, h;
    MicrofacetOracle oracle;
};

template <class Real> Case case_of(const Real *in) {
    return {{in[0], in[1], in[2]},
            {in[3], in[4], in[5]},
            {in[8] > 0.5, std::max(double{in[6]}, 1e-4), std::max(double{in[7]}, 1e-4)}};
}

/// Directions down to a cosine of 1e-6, roughness from 1e-4 (or 0, which becomes that) to 1,
/// normals close to the axis for smooth surfaces and anywhere for others.
template <class Real> std::vector<Real> any_cases(std::size_t count) {
    selftest::Random random(11);
    std::vector<Real> in;
    const auto push = [&](const glm::dvec3 &v) {
        for (int c = 0; c < 3; ++c)
            in.push_back(static_cast<Real>(v[c]));
    };
    for (std::size_t i = 0; i < count; ++i) {
        const double z = i % 3 == 0 ? std::pow(10, random.between(-6, 0)) : random.unit() + 1e-7;
        const double turn = random.between(0, 6.3), across = std::sqrt(1 - z * z);
        push({across * std::cos(turn), across * std::sin(turn), z});
        const double alpha_u = i % 17 == 0 ? 0 : std::pow(10, random.between(-4, 0));
        const double alpha_v = i % 2 == 0 ? alpha_u : std::pow(10, random.between(-4, 0));
        const double tilt = std::tan(random.between(0, 1.5));
        const double around = random.between(0, 6.3);
        glm::dvec3 h =
            glm::normalize(glm::dvec3(std::max(alpha_u, 1e-4) * tilt * std::cos(around),
                                      std::max(alpha_v, 1e-4) * tilt * std::sin(around), 1));
        if (i % 8 == 1)
            h = random.direction();
        push(h);
        in.push_back(static_cast<Real>(alpha_u));
        in.push_back(static_cast<Real>(alpha_v));
        in.push_back(static_cast<Real>(i / 2 % 2));
        in.push_back(random.unit());
        in.push_back(random.unit());
    }
    return in;
}

/// What a change of each coordinate by one unit in the last place changes `f` by, in all.
template <class Real, class F> double wobble(const Real *in, const F &f) {
    const double here = f(case_of(in));
    double sum = 0;
    for (std::size_t i = 0; i < 6; ++i) {
        std::array<Real, in_size> moved;
        std::copy_n(in, in_size, moved.begin());
        moved[i] = std::nextafter(moved[i], Real{2});
        sum += std::abs(f(case_of(moved.data())) - here);
    }
    return sum;
}

template <class Real> void expect_oracle(int lanes, double bar) {
    const std::vector<Real> in = any_cases<Real>(small_tests() ? 64 : 20000);
    const std::vector<Real> out = run(lanes, in);
    Worst d, g1, pdf, length, sampled;
    const auto see = [&](Worst &worst, const Real *record, double found, const auto &f) {
        const double exact = f(case_of(record));
        const double allowed = bar * exact + 8 * wobble(record, f) + 1e-25;
        worst.see(std::abs(found - exact) / allowed);
    };
    for (std::size_t i = 0; i < in.size() / in_size; ++i) {
        const Real *a = &in[in_size * i], *b = &out[out_size * i];
        see(d, a, b[0], [](const Case &c) { return c.oracle.d(c.h); });
        see(g1, a, b[1], [](const Case &c) { return c.oracle.g1(c.wi, c.h); });
        see(pdf, a, b[2], [](const Case &c) { return c.oracle.visible(c.wi, c.h); });
        // Samples are unit vectors above the surface, on the side that is seen.
        const glm::dvec3 h(b[3], b[4], b[5]);
        length.see(std::abs(glm::length(h) - 1));
        length.see(h.z > 0 ? 0 : 1);
        sampled.see(b[6] > 0 && std::isfinite(b[6]) ? 0 : 1);
    }
    INFO(lanes << " lanes, " << sizeof(Real) << " bytes: " << d.value() << ' ' << g1.value() << ' '
               << pdf.value() << ' ' << length.value());
    CHECK(d.value() < 1);
    CHECK(g1.value() < 1);
    CHECK(pdf.value() < 1);
    CHECK(length.value() < 4e-7);
    CHECK(sampled.value() == 0);
}

/// Samples of one distribution seen from `wi` against its density; returns the chi-square in
/// standard deviations, and what the density's integral differs from 1 by.
std::array<double, 2> chi_square(const MicrofacetOracle &oracle, const glm::dvec3 &wi,
                                 std::size_t count) {
    selftest::Random random(3);
    std::vector<float> in;
    for (std::size_t i = 0; i < count; ++i)
        for (const double value :
             {wi.x, wi.y, wi.z, 0.0, 0.0, 1.0, oracle.alpha_u, oracle.alpha_v,
              oracle.beckmann ? 1.0 : 0.0, double{random.unit()}, double{random.unit()}})
            in.push_back(static_cast<float>(value));
    const std::vector<float> out = run(8, in);
    const SphereCells cells({0, 0, 1}, {0, 0, -1}, std::min(oracle.alpha_u, oracle.alpha_v));
    std::vector<double> counts(cells.count());
    for (std::size_t i = 0; i < count; ++i)
        ++counts[cells.cell_of(
            {out[out_size * i + 3], out[out_size * i + 4], out[out_size * i + 5]})];
    const auto densities = [&](const std::vector<glm::dvec3> &normals) {
        std::vector<double> values;
        values.reserve(normals.size());
        for (const glm::dvec3 &h : normals)
            values.push_back(oracle.visible(wi, h));
        return values;
    };
    std::vector<double> expected = cells.integrate(densities, 1e-7, 3);
    const double integral = std::accumulate(expected.begin(), expected.end(), 0.0);
    for (double &value : expected)
        value *= static_cast<double>(count);
    return {selftest::chi_square_deviation(counts, expected), integral - 1};
}

} // namespace

TEST_CASE("microfacets: densities and masking are those of an oracle", "[oclgrind]") {
    for (const int lanes : {1, 8, 16})
        expect_oracle<float>(lanes, 1e-5);
    expect_oracle<double>(1, 1e-12);
}

TEST_CASE("microfacets: sampled normals have the density of visible normals") {
    const std::array<std::array<double, 2>, 6> roughness{
        {{0.01, 0.01}, {0.1, 0.1}, {0.5, 0.5}, {1, 1}, {0.02, 0.4}, {0.8, 0.2}}};
    for (const bool beckmann : {false, true})
        for (const auto &[alpha_u, alpha_v] : roughness)
            for (const double cosine : {1.0, 0.9, 0.5, 0.1, 1e-3}) {
                const double sine = std::sqrt(1 - cosine * cosine);
                const glm::vec3 wi(glm::dvec3(0.8 * sine, -0.6 * sine, cosine));
                const auto [deviation, excess] =
                    chi_square({beckmann, alpha_u, alpha_v}, wi, small_tests() ? 1000 : 100000);
                INFO((beckmann ? "Beckmann " : "GGX ")
                     << alpha_u << ' ' << alpha_v << ", cosine " << cosine);
                // One in a hundred suites of 1000 such tests goes beyond this.
                CHECK(deviation < 4.4);
                CHECK(std::abs(excess) < 1e-3);
            }
}
