/// Small device functions against double precision, at every width.

#include "cl_test_device.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <random>
#include <string>

using namespace clrender;
using namespace clrender::test;

namespace {

constexpr int widths[] = {1, 4, 8, 16};

cl::Program build_probes(const ClTestDevice &device, int lanes) {
    return device.build("probes/function_probes.cl", "-DLANES=" + std::to_string(lanes),
                        embedded_kernel_sources());
}

std::size_t items_for(std::size_t count, int lanes) {
    const auto width = static_cast<std::size_t>(lanes);
    return (count + width - 1) / width;
}

/// What a probe makes of `count` records, `size` floats for each.
std::vector<float> run_probe(const ClTestDevice &device, const std::string &name, int lanes,
                             const std::vector<float> &records, std::size_t count,
                             std::size_t size) {
    cl::Kernel kernel(build_probes(device, lanes), name.c_str());
    const cl::Buffer in = device.upload<float>(records);
    const cl::Buffer out = device.allocate(size * count * sizeof(float));
    kernel.setArg(0, in);
    kernel.setArg(1, out);
    kernel.setArg(2, static_cast<cl_uint>(count));
    device.run(kernel, items_for(count, lanes), 1);
    return device.download<float>(out, size * count);
}

/// The same in double precision, with one lane.
std::vector<double> run_double_probe(const ClTestDevice &device, const std::string &name,
                                     const std::vector<double> &records, std::size_t count,
                                     std::size_t size) {
    const cl::Program program = device.build(
        "probes/function_probes.cl", "-DLANES=1 -DDOUBLE_PRECISION=1", embedded_kernel_sources());
    cl::Kernel kernel(program, name.c_str());
    const cl::Buffer in = device.upload<double>(records);
    const cl::Buffer out = device.allocate(size * count * sizeof(double));
    kernel.setArg(0, in);
    kernel.setArg(1, out);
    kernel.setArg(2, static_cast<cl_uint>(count));
    device.run(kernel, count, 1);
    return device.download<double>(out, size * count);
}

/// The largest of the differences, infinite where one is not a number.
class Worst {
public:
    void add(long double difference) {
        const auto size = static_cast<double>(std::abs(difference));
        worst_ = size <= worst_ ? worst_ : size >= 0 ? size : INFINITY;
    }
    [[nodiscard]] double value() const { return worst_; }

private:
    double worst_ = 0;
};

} // namespace

TEST_CASE("in double precision the functions are right to a few units in the last place",
          "[oclgrind]") {
    const ClTestDevice device;
    std::mt19937 random(6);
    std::uniform_real_distribution<double> uniform;
    std::normal_distribution<double> gauss;
    const std::size_t count = small_tests() ? 50 : 20000;
    constexpr long double two_pi = 2 * std::numbers::pi_v<long double>;
    std::vector<double> turns, vectors, squares, normals;
    for (std::size_t i = 0; i < count; ++i) {
        turns.push_back(uniform(random));
        vectors.insert(vectors.end(), {gauss(random), gauss(random) * (i % 2 == 0 ? 1 : 1e-4)});
        const double distance2 = std::exp(uniform(random) * 40 - 20);
        squares.insert(squares.end(), {distance2, distance2 * uniform(random) * 0.99});
        const glm::dvec3 n =
            glm::normalize(glm::dvec3(gauss(random), gauss(random), gauss(random)));
        normals.insert(normals.end(), {n.x, n.y, n.z});
    }

    Worst sincos, turn, cap, frame;
    const std::vector<double> sines = run_double_probe(device, "probe_sincos", turns, count, 2);
    const std::vector<double> angles = run_double_probe(device, "probe_turn", vectors, count, 1);
    const std::vector<double> caps =
        run_double_probe(device, "probe_sphere_cap", squares, count, 1);
    const std::vector<double> frames = run_double_probe(device, "probe_frame", normals, count, 6);
    for (std::size_t i = 0; i < count; ++i) {
        const long double angle = two_pi * turns[i];
        sincos.add(std::sin(angle) - sines[2 * i]);
        sincos.add(std::cos(angle) - sines[2 * i + 1]);
        turn.add(std::atan2(static_cast<long double>(vectors[2 * i]),
                            static_cast<long double>(vectors[2 * i + 1])) /
                     two_pi -
                 angles[i]);
        const long double sine2 = static_cast<long double>(squares[2 * i + 1]) / squares[2 * i];
        cap.add(caps[i] / (1 - std::sqrt(1 - sine2)) - 1);
        const glm::dvec3 n(normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]);
        const double *f = &frames[6 * i];
        const glm::dvec3 s(f[0], f[1], f[2]), t(f[3], f[4], f[5]);
        for (const double off : {glm::dot(s, s) - 1, glm::dot(t, t) - 1, glm::dot(s, t),
                                 glm::dot(s, n), glm::dot(t, n)})
            frame.add(off);
    }
    CHECK(sincos.value() < 4e-16);
    CHECK(turn.value() < 2e-16);
    CHECK(cap.value() < 1e-14); // of d^2 - r^2, down to a hundredth
    CHECK(frame.value() < 1e-15);
}

TEST_CASE("sine and cosine of a turn are right to 7e-7", "[oclgrind]") {
    const ClTestDevice device;
    const std::size_t count = small_tests() ? 100 : 100000;
    std::vector<float> turns(count);
    for (std::size_t i = 0; i < count; ++i)
        turns[i] = static_cast<float>(i) / static_cast<float>(count);
    turns.back() = std::nextafter(1.0f, 0.0f);
    for (const int lanes : widths) {
        const std::vector<float> values = run_probe(device, "probe_sincos", lanes, turns, count, 2);
        double worst = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(turns[i]);
            worst = std::max(worst, std::abs(std::sin(angle) - double{values[2 * i]}));
            worst = std::max(worst, std::abs(std::cos(angle) - double{values[2 * i + 1]}));
        }
        INFO("width " << lanes);
        CHECK(worst < 7e-7);
    }
}

TEST_CASE("the turn of a vector is right to 6e-8", "[oclgrind]") {
    const ClTestDevice device;
    std::vector<float> vectors = {0, 1, 1, 0, 0, -1, -1, 0, 0, 0, 1, 1, -1, -1};
    const std::vector<float> exact = {0, 0.25f, 0.5f, -0.25f, 0, 0.125f, -0.375f};
    std::mt19937 random(4);
    std::normal_distribution<double> gauss;
    for (int i = 0; i < (small_tests() ? 50 : 100000); ++i) {
        const double size = std::exp(10 * gauss(random));
        vectors.push_back(static_cast<float>(gauss(random) * size));
        vectors.push_back(static_cast<float>(gauss(random) * size * (i % 2 == 0 ? 1 : 1e-4)));
    }
    const std::size_t count = vectors.size() / 2;
    for (const int lanes : widths) {
        const std::vector<float> turns = run_probe(device, "probe_turn", lanes, vectors, count, 1);
        double worst = 0;
        for (std::size_t i = exact.size(); i < count; ++i)
            worst = std::max(
                worst, std::abs(std::atan2(double{vectors[2 * i]}, double{vectors[2 * i + 1]}) /
                                    (2 * std::numbers::pi) -
                                double{turns[i]}));
        INFO("width " << lanes);
        CHECK(worst < 6e-8);
        for (std::size_t i = 0; i < exact.size(); ++i)
            CHECK(turns[i] == Approx(exact[i]).margin(3e-8));
    }
}

TEST_CASE("the cap that a sphere covers is right to 4e-7 of itself at any distance", "[oclgrind]") {
    const ClTestDevice device;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform;
    std::vector<float> squares;
    for (int i = 0; i < (small_tests() ? 50 : 20000); ++i) {
        const double distance2 = std::exp(uniform(random) * 40 - 20);
        // From nearly touching to a ten thousandth of the distance.
        const double sine2 = i % 2 == 0 ? uniform(random) : std::pow(10.0, -8 * uniform(random));
        squares.push_back(static_cast<float>(distance2));
        squares.push_back(static_cast<float>(distance2 * sine2));
    }
    const std::size_t count = squares.size() / 2;
    for (const int lanes : widths) {
        const std::vector<float> caps =
            run_probe(device, "probe_sphere_cap", lanes, squares, count, 1);
        double worst = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const long double sine2 = static_cast<long double>(squares[2 * i + 1]) / squares[2 * i];
            if (sine2 >= 1)
                continue;
            const long double cap = 1 - std::sqrt(1 - sine2);
            REQUIRE(caps[i] > 0.0f); // a NaN would be no maximum
            worst = std::max(worst, std::abs(static_cast<double>(caps[i] / cap - 1)));
        }
        INFO("width " << lanes);
        CHECK(worst < 4e-7);
    }
}

TEST_CASE("random numbers lie in [0, 1), are uniform and the same at every width", "[oclgrind]") {
    const ClTestDevice device;
    const std::size_t count = small_tests() ? 200 : 200000;
    std::vector<float> narrow;
    for (const int lanes : widths) {
        cl::Kernel kernel(build_probes(device, lanes), "probe_sampler");
        const cl::Buffer out = device.allocate(count * sizeof(float));
        kernel.setArg(0, out);
        kernel.setArg(1, cl_uint{7});
        kernel.setArg(2, cl_uint{4000000000u});
        kernel.setArg(3, cl_uint{5});
        kernel.setArg(4, static_cast<cl_uint>(count));
        device.run(kernel, items_for(count, lanes), 1);
        const std::vector<float> values = device.download<float>(out, count);
        if (lanes == 1)
            narrow = values;
        CHECK(values == narrow);
    }
    // Chi-square over 64 cells: 63 degrees of freedom, standard deviation 11.2.
    std::vector<double> cells(64, 0.0);
    for (const float v : narrow) {
        REQUIRE(v >= 0.0f);
        REQUIRE(v < 1.0f);
        ++cells[static_cast<std::size_t>(v * 64)];
    }
    const double expected = static_cast<double>(count) / 64;
    double chi2 = 0;
    for (const double n : cells)
        chi2 += (n - expected) * (n - expected) / expected;
    CHECK(chi2 > 63 - 5 * 11.2);
    CHECK(chi2 < 63 + 5 * 11.2);
}

TEST_CASE("frames are orthonormal for all normals", "[oclgrind]") {
    const ClTestDevice device;
    std::vector<float> normals = {0, 0, 1, 0, 0, -1, 1, 0, 0, 0, -1, 0, -0.0f, 0, -1};
    std::mt19937 random(3);
    std::normal_distribution<double> gauss;
    for (int i = 0; i < (small_tests() ? 50 : 5000); ++i) {
        const glm::dvec3 n = glm::normalize(
            glm::dvec3(gauss(random), gauss(random), gauss(random) * (i % 2 == 0 ? 1 : 1e-4)));
        for (int c = 0; c < 3; ++c)
            normals.push_back(static_cast<float>(n[c]));
    }
    const std::size_t count = normals.size() / 3;
    for (const int lanes : widths) {
        const std::vector<float> values =
            run_probe(device, "probe_frame", lanes, normals, count, 6);
        double worst = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const glm::dvec3 n(normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]);
            const glm::dvec3 s(values[6 * i], values[6 * i + 1], values[6 * i + 2]);
            const glm::dvec3 t(values[6 * i + 3], values[6 * i + 4], values[6 * i + 5]);
            for (const double error : {glm::dot(n, s), glm::dot(n, t), glm::dot(s, t),
                                       glm::length(s) - 1, glm::length(t) - 1})
                worst = std::max(worst, std::abs(error));
        }
        INFO("width " << lanes);
        CHECK(worst < 1e-6);
    }
}
