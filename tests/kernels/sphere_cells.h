#pragma once
/// Cells of the sphere of directions for chi-square tests of sampling routines, bounded by
/// parallels and meridians: in each hemisphere they are narrow around a direction where a density
/// may have a peak, and around the pole, and grow with their distance from both. They end at the
/// horizon z = 0.

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

    [[nodiscard]] std::size_t count() const { return count_; }

    /// The cell that direction `d` is in.
    [[nodiscard]] std::size_t cell_of(const glm::dvec3 &d) const;

    /// Densities per solid angle in many directions at once.
    using Densities = std::function<std::vector<double>(const std::vector<glm::dvec3> &)>;

    /// The integral of a density over each cell, to `tolerance` in each. All cells are divided
    /// `certain_levels` times: more often where the density ends within cells.
    [[nodiscard]] std::vector<double> integrate(const Densities &densities, double tolerance,
                                                int certain_levels = 1) const;

private:
    /// A hemisphere: limits of |z|, from 0 to 1, and of the azimuth in radians, a turn in all.
    struct Grid {
        std::vector<double> heights, azimuths;
        std::size_t first = 0; ///< its cells are numbered from here on
    };

    std::array<Grid, 2> grids_; ///< upper, lower
    std::size_t count_ = 0;
};

} // namespace clrender::test
