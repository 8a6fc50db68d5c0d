#include "sphere_cells.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clrender::test {

namespace {

constexpr double pi = std::numbers::pi;

constexpr int levels = 9; ///< of quarters in quarters, at most

/// A part of a cell, and what was found for its integral before.
struct Part {
    std::size_t cell;
    double x0, x1, y0, y1; ///< heights and azimuths
    double sign;           ///< of z
    double before = 0;

    [[nodiscard]] std::array<Part, 4> quarters() const {
        const double x = (x0 + x1) / 2, y = (y0 + y1) / 2;
        return {{{cell, x0, x, y0, y, sign},
                 {cell, x, x1, y0, y, sign},
                 {cell, x0, x, y, y1, sign},
                 {cell, x, x1, y, y1, sign}}};
    }
};

/// The points of Gauss-Legendre quadrature with 3 x 3 points, and their weights.
template <class Visit> void gauss(const Part &p, const Visit &visit) {
    static const double offset = std::sqrt(0.6);
    const double half_x = (p.x1 - p.x0) / 2, half_y = (p.y1 - p.y0) / 2;
    for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j)
            visit(p.x0 + half_x * (1 + i * offset), p.y0 + half_y * (1 + j * offset),
                  (i == 0 ? 8 : 5) * (j == 0 ? 8 : 5) * half_x * half_y / 81);
}

/// `low`, `high` and what lies between them of center +- narrow * 2^k.
void add_around(std::vector<double> &limits, double center, double narrow, double low,
                double high) {
    limits.insert(limits.end(), {low, high});
    for (double off = narrow; off < high - low; off *= 2)
        for (const double limit : {center - off, center + off})
            if (limit > low && limit < high)
                limits.push_back(limit);
}

/// In order, without those that leave no room between them.
void tidy(std::vector<double> &limits, double least) {
    std::sort(limits.begin(), limits.end());
    const double last = limits.back();
    std::vector<double> kept{limits.front()};
    for (const double limit : limits)
        if (limit - kept.back() > least && last - limit > least)
            kept.push_back(limit);
    kept.push_back(last);
    limits = kept;
}

std::size_t interval_of(const std::vector<double> &limits, double x) {
    const auto above = std::upper_bound(limits.begin() + 1, limits.end() - 1, x);
    return static_cast<std::size_t>(above - limits.begin()) - 1;
}

} // namespace

SphereCells::SphereCells(const glm::dvec3 &upper, const glm::dvec3 &lower, double narrow) {
    for (const bool below : {false, true}) {
        const glm::dvec3 &peak = below ? lower : upper;
        Grid &grid = grids_[below ? 1 : 0];
        const double height = std::abs(peak.z), across = std::sqrt(1 - height * height);
        // A peak at the pole is a disk of this height; off it, its height is foreshortened.
        const double thin = narrow * std::max(across, narrow / 2);
        add_around(grid.heights, height, thin, 0, 1);
        add_around(grid.heights, 1, narrow * narrow / 2, 0, 1);
        tidy(grid.heights, thin / 4);
        const double azimuth = std::atan2(peak.y, peak.x);
        add_around(grid.azimuths, azimuth, std::min(narrow / std::max(across, 1e-9), 0.5),
                   azimuth - pi, azimuth + pi);
        tidy(grid.azimuths, 1e-9);
        grid.first = count_;
        count_ += (grid.heights.size() - 1) * (grid.azimuths.size() - 1);
    }
}

std::size_t SphereCells::cell_of(const glm::dvec3 &d) const {
    const Grid &grid = grids_[d.z < 0 ? 1 : 0];
    // In single precision, x and y tell more of the height next to the pole.
    const double across2 = d.x * d.x + d.y * d.y;
    const double height = across2 < 0.5 ? std::sqrt(1 - across2) : std::abs(d.z);
    double azimuth = std::atan2(d.y, d.x);
    azimuth += azimuth < grid.azimuths.front() ? 2 * pi : 0;
    azimuth -= azimuth > grid.azimuths.back() ? 2 * pi : 0;
    return grid.first + interval_of(grid.heights, height) * (grid.azimuths.size() - 1) +
           interval_of(grid.azimuths, azimuth);
}

std::vector<double> SphereCells::integrate(const Densities &densities, double tolerance,
                                           int certain_levels) const {
    std::vector<Part> parts;
    for (const Grid &grid : grids_)
        for (std::size_t i = 0; i + 1 < grid.heights.size(); ++i)
            for (std::size_t j = 0; j + 1 < grid.azimuths.size(); ++j)
                parts.push_back({parts.size(), grid.heights[i], grid.heights[i + 1],
                                 grid.azimuths[j], grid.azimuths[j + 1],
                                 &grid == &grids_[0] ? 1.0 : -1.0});

    // Quarters of the parts where the rule and that of their quarters differ.
    std::vector<double> sums(count());
    for (int level = 0; !parts.empty(); ++level) {
        std::vector<glm::dvec3> points;
        for (const Part &part : parts)
            for (const Part &quarter : part.quarters())
                gauss(quarter, [&](double height, double azimuth, double) {
                    const double across = std::sqrt(1 - height * height);
                    points.emplace_back(across * std::cos(azimuth), across * std::sin(azimuth),
                                        part.sign * height);
                });
        const std::vector<double> values = densities(points);
        std::vector<Part> rest;
        std::size_t at = 0;
        for (const Part &part : parts) {
            auto quarters = part.quarters();
            double sum = 0;
            for (Part &quarter : quarters) {
                gauss(quarter, [&](double, double, double weight) {
                    quarter.before += weight * values[at++];
                });
                sum += quarter.before;
            }
            const double close = tolerance * std::pow(3.0, -level);
            const bool settled = std::abs(sum - part.before) <= close;
            if (level == levels || (level >= certain_levels && settled))
                sums[part.cell] += sum;
            else
                rest.insert(rest.end(), quarters.begin(), quarters.end());
        }
        parts = std::move(rest);
    }
    return sums;
}

} // namespace clrender::test
