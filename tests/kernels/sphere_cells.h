#pragma once
/// Cells of the sphere of directions for chi-square tests of sampling routines: each hemisphere is
/// divided around an axis of its own, where a density may have a peak, into rings whose widths grow
/// with their distance from it, and sectors. Cells end at the horizon z = 0.

#include <glm/glm.hpp>

#include <array>
#include <functional>
#include <vector>

namespace clrender::test {

class SphereCells {
public:
    /// `upper` and `lower` are unit vectors with z >= 0 and z <= 0; `narrow` is the smallest angle
    /// that peaks have, in radians.
    SphereCells(const glm::dvec3 &upper, const glm::dvec3 &lower, double narrow);

    [[nodiscard]] std::size_t count() const { return 2 * rings_.size() * sectors; }

    /// The cell that direction `d` is in.
    [[nodiscard]] std::size_t cell_of(const glm::dvec3 &d) const;

    /// The integral of `density` (per solid angle) over each cell, to `tolerance` in each.
    [[nodiscard]] std::vector<double>
    integrate(const std::function<double(const glm::dvec3 &)> &density, double tolerance) const;

private:
    static constexpr std::size_t sectors = 12;

    /// A hemisphere's chart: an axis and two vectors across it.
    struct Chart {
        glm::dvec3 axis, s, t;
    };

    std::array<Chart, 2> charts_; ///< upper, lower
    /// Upper ends of the rings in (1 - cosine) / 2, which is proportional to area; the last is 1.
    std::vector<double> rings_;
};

} // namespace clrender::test
