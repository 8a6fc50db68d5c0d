#pragma once
/// What a check of a device function finds: a figure beside its bar.

#include <glm/glm.hpp>

#include <cstddef>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace clrender::selftest {

/// One row of the table: `figure` of `function` may be `bar` at most; a NaN is beyond every bar.
struct Check {
    std::string function; ///< as the kernels name it
    std::string what;     ///< the figure in words, with its unit
    double figure = 0;
    double bar = 0;

    [[nodiscard]] bool passed() const { return figure <= bar; }
};

/// The row as a line: `check  FUNCTION  WHAT  FIGURE  <= BAR  pass`, or `FAIL`.
std::string describe(const Check &check);

/// The largest of the errors it is shown; infinite once one of them is no number.
class Worst {
public:
    void see(double error);
    [[nodiscard]] double value() const { return worst_; }

private:
    double worst_ = 0;
};

/// The share of answers that are wrong; infinite before the first, so that nothing seen is no pass.
class WrongShare {
public:
    void see(bool wrong) {
        wrong_ += wrong ? 1 : 0;
        ++count_;
    }
    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] double value() const;

private:
    std::size_t wrong_ = 0, count_ = 0;
};

/// How far counts are from what is expected of them, by Pearson's chi-square: standard deviations
/// of the normal variable that Wilson and Hilferty make of it ("The distribution of chi-square",
/// 1931). Cells with less than 5 expected are taken together.
double chi_square_deviation(std::span<const double> counts, std::span<const double> expected);

/// The same for numbers in [0, 1)^2 against even ones, on a grid of side x side cells. A number
/// outside gives infinity.
double deviation_from_even(std::span<const glm::dvec2> points, int side);

/// A float's distance to the next.
double ulp(double value);

/// Numbers that every run and every standard library makes alike.
class Random {
public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}

    /// In [0, 1), a multiple of 2^-24, as the device's own.
    float unit();
    double between(double low, double high);
    /// Uniform on the unit sphere, each component a float.
    glm::dvec3 direction();
    /// Uniform in [-1, 1]^3.
    glm::dvec3 point();
    std::uint32_t bits() { return static_cast<std::uint32_t>(engine_()); }

private:
    std::mt19937 engine_;
};

/// Rounded to float.
inline glm::dvec3 rounded(const glm::dvec3 &v) {
    return glm::dvec3(glm::vec3(v));
}

} // namespace clrender::selftest
