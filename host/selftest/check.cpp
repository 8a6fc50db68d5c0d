#include "check.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <limits>
#include <numbers>

namespace clrender::selftest {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

} // namespace

std::string describe(const Check &check) {
    return fmt::format("check  {:<26} {:<58} {:>9.3g}  <= {:<8.3g} {}", check.function, check.what,
                       check.figure, check.bar, check.passed() ? "pass" : "FAIL");
}

void Worst::see(double error) {
    if (std::isnan(error))
        worst_ = infinity;
    else
        worst_ = std::max(worst_, error);
}

double WrongShare::value() const {
    return count_ == 0 ? infinity : static_cast<double>(wrong_) / static_cast<double>(count_);
}

double chi_square_deviation(std::span<const double> counts, std::span<const double> expected) {
    constexpr double least = 5;
    double sum = 0, rest = 0, rest_expected = 0;
    int cells = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        if (expected[i] < least) {
            rest += counts[i];
            rest_expected += expected[i];
            continue;
        }
        sum += (counts[i] - expected[i]) * (counts[i] - expected[i]) / expected[i];
        ++cells;
    }
    if (rest_expected >= least) {
        sum += (rest - rest_expected) * (rest - rest_expected) / rest_expected;
        ++cells;
    } else if (rest > rest_expected + 5 * std::sqrt(rest_expected) + least) {
        return infinity; // where next to nothing should be
    }
    const double freedom = cells - 1;
    if (freedom < 1)
        return 0;
    const double spread = 2 / (9 * freedom);
    return (std::cbrt(sum / freedom) - (1 - spread)) / std::sqrt(spread);
}

double deviation_from_even(std::span<const glm::dvec2> points, int side) {
    const auto n = static_cast<std::size_t>(side);
    std::vector<double> counts(n * n, 0.0);
    for (const glm::dvec2 &p : points) {
        if (!(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1))
            return infinity;
        ++counts[static_cast<std::size_t>(p.y * side) * n + static_cast<std::size_t>(p.x * side)];
    }
    const std::vector<double> expected(n * n, static_cast<double>(points.size()) /
                                                  static_cast<double>(n * n));
    return chi_square_deviation(counts, expected);
}

double ulp(double value) {
    const auto v = static_cast<float>(std::abs(value));
    return double{std::nextafter(v, std::numeric_limits<float>::infinity())} - double{v};
}

float Random::unit() {
    return static_cast<float>(bits() >> 8u) * 0x1p-24f;
}

double Random::between(double low, double high) {
    return low + (high - low) * double{unit()};
}

glm::dvec3 Random::direction() {
    const double z = between(-1, 1), turn = 2 * std::numbers::pi * double{unit()};
    const double r = std::sqrt(1 - z * z);
    return rounded({r * std::cos(turn), r * std::sin(turn), z});
}

glm::dvec3 Random::point() {
    const double x = between(-1, 1), y = between(-1, 1);
    return rounded({x, y, between(-1, 1)});
}

} // namespace clrender::selftest
