/// kernels/sphere_chain.clh against rays traced in double precision.

#include "cl_test_device.h"
#include "config/kernel_config.h"
#include "selftest/check.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <optional>

using namespace clrender;
using namespace clrender::test;
using glm::dvec3;

namespace {

constexpr std::size_t in_size = 8, out_size = 9; ///< of probe_sphere_chain
constexpr double pi = std::numbers::pi;

struct Ray {
    dvec3 o, d;
};

dvec3 refracted(const dvec3 &d, const dvec3 &n, double ratio) {
    const double cosine = -glm::dot(d, n);
    const double rest = 1 - ratio * ratio * (1 - cosine * cosine);
    return glm::normalize(d * ratio + n * (ratio * cosine - std::sqrt(rest)));
}

/// What becomes of a ray at the unit sphere around the origin: reflected where `k` is 0, else
/// refracted into it and out of it, k being the inverse of its index.
std::optional<Ray> trace(const Ray &in, double k) {
    const double along = -glm::dot(in.o, in.d);
    const double inside = 1 - (glm::dot(in.o, in.o) - along * along);
    if (inside < 0 || along < 0)
        return std::nullopt;
    const dvec3 n = in.o + in.d * (along - std::sqrt(inside));
    if (k == 0)
        return Ray{n, in.d - n * (2 * glm::dot(in.d, n))};
    const dvec3 d = refracted(in.d, n, k);
    const dvec3 leaving = n - d * (2 * glm::dot(d, n));
    return Ray{leaving, refracted(d, -leaving, 1 / k)};
}

/// Solid angle around the direction of `in` over the area that it covers at y across the ray that
/// arrives there, by differences.
double geometry_by_differences(const Ray &in, double k, const dvec3 &y, const dvec3 &arriving) {
    const dvec3 u = glm::normalize(glm::cross(in.d, dvec3(0.3, 0.5, 0.8)));
    const dvec3 v = glm::cross(in.d, u);
    const auto at_plane = [&](const dvec3 &d) {
        const Ray out = trace({in.o, glm::normalize(d)}, k).value();
        const double t = glm::dot(y - out.o, arriving) / glm::dot(out.d, arriving);
        return out.o + out.d * t;
    };
    constexpr double step = 1e-6;
    const dvec3 by_u = (at_plane(in.d + u * step) - at_plane(in.d - u * step)) / (2 * step);
    const dvec3 by_v = (at_plane(in.d + v * step) - at_plane(in.d - v * step)) / (2 * step);
    return 1 / glm::length(glm::cross(by_u, by_v));
}

/// A ray from x = (-1/a, 0, 0) that meets the sphere at the angle i, towards +y.
Ray ray_at(double a, double i) {
    const double sine = a * std::sin(i);
    return {{-1 / a, 0, 0}, {std::sqrt(1 - sine * sine), sine, 0}};
}

/// The angle at the centre from x to where a ray at this angle comes to the distance 1/b, from 0
/// to 2 pi; NaN where it never does.
double swept(double a, double b, double k, double i) {
    const std::optional<Ray> out = trace(ray_at(a, i), k);
    if (!out)
        return std::nan("");
    const double along = glm::dot(out->o, out->d);
    const double t = -along + std::sqrt(along * along + 1 / (b * b) - 1);
    const dvec3 y = out->o + out->d * t;
    const double angle = std::atan2(y.y, -y.x);
    return angle < 0 ? angle + 2 * pi : angle;
}

template <class Real> std::vector<Real> run(int lanes, const std::vector<double> &in) {
    static const ClTestDevice *const device = new ClTestDevice;
    KernelConfig config;
    config.LANES = lanes;
    config.DOUBLE_PRECISION = sizeof(Real) == sizeof(double) ? 1 : 0;
    config.CONNECTS_SPHERES = config.CONNECTS_GLASS = 1;
    cl::Kernel kernel(device->build("probes/sphere_chain_probes.cl", config.build_options()),
                      "probe_sphere_chain");
    const std::vector<Real> records(in.begin(), in.end());
    return device->run_records(kernel, lanes, records, in_size, out_size);
}

/// Points at 1.01 to 30 radii from the centre, indices from 1.1 to 2.5; the place of y follows from
/// an angle of incidence, so that there is a way.
struct Case {
    double a, b, k, incidence;
};

std::vector<Case> cases(std::size_t count) {
    selftest::Random random(5);
    std::vector<Case> all;
    for (std::size_t n = 0; n < count; ++n)
        all.push_back({std::pow(10, -random.between(0.005, 1.5)),
                       std::pow(10, -random.between(0.005, 1.5)),
                       n % 3 == 0 ? 0 : 1 / random.between(1.1, 2.5), random.between(0.01, 1.5)});
    return all;
}

template <class Real> void check_ways(int lanes, double turn_bar, double geometry_bar) {
    const std::vector<Case> all = cases(small_tests() ? 60 : 3000);
    std::vector<double> in;
    std::vector<double> places;
    for (const Case &c : all) {
        const double place = swept(c.a, c.b, c.k, c.incidence);
        REQUIRE(std::isfinite(place));
        places.push_back(place);
        const double target = c.k > 0 ? pi - place : place;
        in.insert(in.end(), {c.a, c.b, 1 - c.a * c.a, 1 - c.b * c.b, c.k, std::cos(target),
                             std::abs(std::sin(target)), c.k > 0 ? 1.0 : 0.0});
    }
    const std::vector<Real> out = run<Real>(lanes, in);
    selftest::Worst off, geometry;
    std::size_t missed = 0, ways = 0;
    for (std::size_t n = 0; n < all.size(); ++n) {
        const Case &c = all[n];
        bool found = false;
        for (std::size_t piece = 0; piece < 3; ++piece) {
            const Real *way = &out[n * out_size + 3 * piece];
            if (!(way[0] > 0))
                continue;
            ++ways;
            const double i = 2 * std::atan(double{way[1]});
            const double place = swept(c.a, c.b, c.k, i);
            // y may as well be the mirror image of where the ray comes to, on the other side.
            const double error = std::abs(std::sin(place - places[n]));
            const double mirrored = std::abs(std::sin(place + places[n]));
            off.see(std::min(error, mirrored));
            found |= std::abs(i - c.incidence) < 1e-3;
            // Rays beside one that grazes the sphere miss it.
            if (std::cos(i) < 0.02)
                continue;
            const Ray ray = ray_at(c.a, i);
            const Ray leaving = trace(ray, c.k).value();
            const double along = glm::dot(leaving.o, leaving.d);
            const double t = -along + std::sqrt(along * along + 1 / (c.b * c.b) - 1);
            const double expected =
                geometry_by_differences(ray, c.k, leaving.o + leaving.d * t, leaving.d);
            // At a focus or on the axis the term has a pole, where rounding of i shows.
            if (expected < 10 * c.a * c.a && std::sin(i) > 0.02)
                geometry.see(std::abs(way[2] / expected - 1));
        }
        missed += found ? 0 : 1;
    }
    CHECK(ways > all.size());
    CHECK(off.value() < turn_bar);
    CHECK(geometry.value() < geometry_bar);
    // At a focus two ways become one, and either may be seen.
    CHECK(static_cast<double>(missed) < 0.01 * static_cast<double>(all.size()));
}

} // namespace

TEST_CASE("ways over a sphere lead where rays traced in double precision come to") {
    check_ways<float>(4, 5e-5, 5e-3);
}

TEST_CASE("in double precision they do to far more digits") {
    check_ways<double>(1, 1e-9, 3e-4); // what is left is the differences' own
}
