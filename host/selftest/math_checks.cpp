#include "checks.h"

#include <array>
#include <cmath>
#include <numbers>

namespace clrender::selftest {

namespace {

constexpr double pi = std::numbers::pi;
constexpr std::size_t in_size = 12, out_size = 16;

/// Inputs of probe_math.
std::vector<float> math_inputs(std::size_t count) {
    Random random(3);
    std::vector<float> in;
    in.reserve(count * in_size);
    // Where signs, zeros and equal components meet.
    const std::array<std::array<float, 2>, 8> vectors{
        {{0, 1}, {1, 0}, {0, -1}, {-1, 0}, {1, 1}, {-1, -1}, {1e-30f, 1e30f}, {-1e30f, 1e-30f}}};
    const std::array<glm::vec3, 5> normals{
        {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {-0.0f, 0, -1}}};
    for (std::size_t i = 0; i < count; ++i) {
        in.push_back(i == 0 ? std::nextafter(1.0f, 0.0f) : random.unit());
        const double size = std::exp(random.between(-25, 25));
        const double flat = i % 2 == 0 ? 1 : 1e-4;
        in.push_back(i < vectors.size() ? vectors[i][0]
                                        : static_cast<float>(random.between(-1, 1) * size));
        in.push_back(i < vectors.size() ? vectors[i][1]
                                        : static_cast<float>(random.between(-1, 1) * size * flat));
        const double distance2 = std::exp(random.between(-20, 20));
        // From nearly touching to a ten thousandth of the distance.
        const double sine2 = i % 2 == 0 ? double{random.unit()} * 0.999
                                        : std::pow(10.0, -8 * double{random.unit()}) * 0.999;
        in.push_back(static_cast<float>(distance2));
        in.push_back(static_cast<float>(distance2 * sine2));
        glm::dvec3 n = random.direction();
        if (i % 2 == 1)
            n = glm::normalize(n * glm::dvec3(1, 1, 1e-4));
        for (int c = 0; c < 3; ++c)
            in.push_back(i < normals.size() ? normals[i][c] : static_cast<float>(n[c]));
        // The first time neither way finds the direction.
        const bool none = i == 0;
        in.push_back(none ? 0 : static_cast<float>(std::exp(random.between(-15, 15))));
        in.push_back(none ? 0 : static_cast<float>(std::exp(random.between(-15, 15))));
        in.push_back(random.unit());
        in.push_back(random.unit());
    }
    return in;
}

} // namespace

Checks check_math(ProbeDevice &device) {
    const std::size_t count = device.count(1e5);
    const std::vector<float> in = math_inputs(count);
    const std::vector<float> out = device.run("probe_math", in, in_size, out_size);
    Worst sincos, turn, cap, frame, weight, cosine;
    std::vector<glm::dvec2> even;
    for (std::size_t i = 0; i < count; ++i) {
        std::array<double, in_size> a{};
        std::array<double, out_size> b{};
        for (std::size_t k = 0; k < in_size; ++k)
            a[k] = in[in_size * i + k];
        for (std::size_t k = 0; k < out_size; ++k)
            b[k] = out[out_size * i + k];
        sincos.see(std::abs(b[0] - std::sin(2 * pi * a[0])));
        sincos.see(std::abs(b[1] - std::cos(2 * pi * a[0])));
        const double angle = std::atan2(a[1], a[2]) / (2 * pi);
        // Half a turn is minus half a turn.
        turn.see(std::abs(std::remainder(b[2] - angle, 1.0)));
        const long double sine2 = static_cast<long double>(a[4]) / a[3];
        cap.see(static_cast<double>(std::abs(b[3] / (1 - std::sqrt(1 - sine2)) - 1)));
        const glm::dvec3 n(a[5], a[6], a[7]), s(b[4], b[5], b[6]), t(b[7], b[8], b[9]);
        frame.see(glm::length(glm::cross(s, t) - n));
        for (const double error :
             {glm::dot(n, s), glm::dot(n, t), glm::dot(s, t), glm::length(s) - 1})
            frame.see(std::abs(error));
        const double ratio = a[9] / a[8];
        weight.see(i == 0 ? b[10] : std::abs(b[10] * (1 + ratio * ratio) - 1));
        const double product = a[8] * a[9];
        if (i > 0)
            weight.see(std::abs(b[11] / a[8] * (1 + product * product) - 1));
        const glm::dvec3 d(b[12], b[13], b[14]);
        cosine.see(std::abs(glm::length(d) - 1));
        cosine.see(std::abs(glm::dot(d, n) - b[15]));
        cosine.see(std::abs(b[15] - std::sqrt(1 - a[11])));
        cosine.see(b[15] > 0 ? 0 : 1);
        const double x = glm::dot(d, s), y = glm::dot(d, t), z2 = b[15] * b[15];
        const double phi = std::atan2(y, x) / (2 * pi);
        even.emplace_back(std::min(phi - std::floor(phi), 1 - 1e-12), std::min(1 - z2, 1 - 1e-12));
    }
    return {
        {"sincos_turn", "largest absolute error", sincos.value(), 7e-7},
        {"turn_of", "largest absolute error, turns", turn.value(), 6e-8},
        {"sphere_cap", "largest relative error", cap.value(), 4e-7},
        {"make_frame", "largest deviation from orthonormal", frame.value(), 1e-6},
        {"mis_weight", "largest relative error", weight.value(), 1e-6},
        {"sample_cosine", "largest absolute error of length and cosine", cosine.value(), 1.5e-6},
        {"sample_cosine", "chi-square against cos / pi, deviations", deviation_from_even(even, 16),
         4}};
}

Checks check_numbers(ProbeDevice &device) {
    constexpr std::array<std::uint32_t, 8> corners{
        0u, 1u, 63u, 0x7fffffffu, 0x80000000u, 0xfffffffeu, 0xffffffffu, 0x00ffffffu};
    const std::size_t count = device.count(2e5);
    Random random(8);
    // Half of all inputs are corners, the rest anything.
    const auto any = [&] {
        const std::uint32_t which = random.bits();
        return which % 2 == 0 ? corners[which / 2 % corners.size()] : random.bits();
    };
    std::vector<std::uint32_t> groups, in;
    for (std::size_t i = 0; i < count / probe_group; ++i) {
        groups.push_back(any());
        groups.push_back(any());
    }
    for (std::size_t i = 0; i < 2 * count; ++i)
        in.push_back(any());
    cl::Kernel kernel = device.kernel("probe_numbers");
    // The kernel keeps no hold of the buffers that are its arguments.
    const cl::Buffer all_inputs = device.upload(groups);
    kernel.setArg(0, all_inputs);
    const std::vector<float> out = device.launch(kernel, 1, device.upload(in), count, 5);
    WrongShare outside;
    for (const float u : out)
        outside.see(!(u >= 0 && u < 1));

    // One pixel after another, one sample each: the numbers fill the square evenly.
    std::fill(groups.begin(), groups.end(), 5u);
    for (std::size_t i = 0; i < count; ++i) {
        in[2 * i] = static_cast<std::uint32_t>(i);
        in[2 * i + 1] = 77u;
    }
    const cl::Buffer one_seed = device.upload(groups);
    kernel.setArg(0, one_seed);
    const std::vector<float> spread = device.launch(kernel, 1, device.upload(in), count, 5);
    std::vector<glm::dvec2> two, pair;
    for (std::size_t i = 0; i < count; ++i) {
        two.emplace_back(spread[5 * i + 1], spread[5 * i + 2]);
        pair.emplace_back(spread[5 * i + 3], spread[5 * i + 4]);
    }
    return {
        {"sampler_get", "share of numbers outside [0, 1), all inputs", outside.value(), 0},
        {"sampler_get_two", "chi-square against even, deviations", deviation_from_even(two, 16), 4},
        {"sampler_get_pair", "chi-square against even, deviations", deviation_from_even(pair, 16),
         4}};
}

} // namespace clrender::selftest
