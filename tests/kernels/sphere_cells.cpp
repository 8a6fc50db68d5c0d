#include "sphere_cells.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clrender::test {

namespace {

constexpr double two_pi = 2 * std::numbers::pi;

struct Rectangle {
    double x0, x1, y0, y1;
};

/// Gauss-Legendre with 3 x 3 points.
template <class F> double gauss(const F &f, const Rectangle &r) {
    static const double offset = std::sqrt(0.6);
    const double half_x = (r.x1 - r.x0) / 2, half_y = (r.y1 - r.y0) / 2;
    double sum = 0;
    for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j)
            sum += (i == 0 ? 8 : 5) * (j == 0 ? 8 : 5) *
                   f(r.x0 + half_x * (1 + i * offset), r.y0 + half_y * (1 + j * offset));
    return sum * half_x * half_y / 81;
}

constexpr int levels = 9;         ///< of quarters in quarters, at most
constexpr int certain_levels = 3; ///< of all cells, so that no corner of a support is missed

/// Quarters where the rule and that of its four quarters differ by more than `tolerance`.
template <class F>
double adaptive(const F &f, const Rectangle &r, double whole, double tolerance, int level = 0) {
    const double x = (r.x0 + r.x1) / 2, y = (r.y0 + r.y1) / 2;
    const std::array<Rectangle, 4> quarters{
        {{r.x0, x, r.y0, y}, {x, r.x1, r.y0, y}, {r.x0, x, y, r.y1}, {x, r.x1, y, r.y1}}};
    std::array<double, 4> parts{};
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        parts[i] = gauss(f, quarters[i]);
        sum += parts[i];
    }
    if (level == levels || (level >= certain_levels && std::abs(sum - whole) <= tolerance))
        return sum;
    sum = 0;
    for (std::size_t i = 0; i < 4; ++i)
        sum += adaptive(f, quarters[i], parts[i], tolerance / 3, level + 1);
    return sum;
}

} // namespace

SphereCells::SphereCells(const glm::dvec3 &upper, const glm::dvec3 &lower, double narrow) {
    const auto chart = [](const glm::dvec3 &axis) {
        const glm::dvec3 other = std::abs(axis.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
        const glm::dvec3 s = glm::normalize(glm::cross(axis, other));
        return Chart{axis, s, glm::cross(axis, s)};
    };
    charts_ = {chart(upper), chart(lower)};
    // Each ring twice as wide in angle as all within it, the last ones even.
    for (double end = narrow * narrow / 4; end < 0.1; end *= 3)
        rings_.push_back(end);
    for (const double end : {0.1, 0.2, 0.35, 0.5, 0.75, 1.0})
        rings_.push_back(end);
}

std::size_t SphereCells::cell_of(const glm::dvec3 &d) const {
    const bool below = d.z < 0;
    const Chart &chart = charts_[below ? 1 : 0];
    const glm::dvec3 off = d - chart.axis;
    // |d - axis|^2 / 4 keeps what 1 - cosine would lose next to the axis.
    const double height = std::min(glm::dot(off, off) / 4, 1.0);
    const auto ring = static_cast<std::size_t>(
        std::lower_bound(rings_.begin(), rings_.end() - 1, height) - rings_.begin());
    const double turn = std::atan2(glm::dot(d, chart.t), glm::dot(d, chart.s)) / two_pi;
    const auto sector =
        std::min(static_cast<std::size_t>((turn - std::floor(turn)) * sectors), sectors - 1);
    return ((below ? rings_.size() : 0) + ring) * sectors + sector;
}

std::vector<double> SphereCells::integrate(const std::function<double(const glm::dvec3 &)> &density,
                                           double tolerance) const {
    std::vector<double> sums;
    for (const Chart &chart : charts_) {
        const bool lower = &chart == &charts_[1];
        double start = 0;
        const auto at = [&](double height, double turn) {
            const double sine = 2 * std::sqrt(height * (1 - height));
            const glm::dvec3 d =
                (1 - 2 * height) * chart.axis +
                sine * (std::cos(two_pi * turn) * chart.s + std::sin(two_pi * turn) * chart.t);
            return (d.z < 0) == lower ? density(d) * 2 * two_pi : 0.0;
        };
        for (const double end : rings_) {
            for (std::size_t sector = 0; sector < sectors; ++sector) {
                const Rectangle cell{start, end, static_cast<double>(sector) / sectors,
                                     static_cast<double>(sector + 1) / sectors};
                sums.push_back(adaptive(at, cell, gauss(at, cell), tolerance));
            }
            start = end;
        }
    }
    return sums;
}

} // namespace clrender::test
