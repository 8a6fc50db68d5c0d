#pragma once
/// What the control tiles of a render tell of its error.

#include "image/image.h"
#include "shared/control_tile.h"

#include <algorithm>
#include <cstddef>
#include <span>

namespace clrender {

/// The tiles of a picture, and how many of them share a control tile.
struct ControlLayout {
    std::size_t width = 0, height = 0; ///< of the picture, pixels
    std::size_t side = 1;              ///< of a tile, pixels
    std::size_t group = 0;             ///< tiles; 0: no control tiles

    [[nodiscard]] std::size_t columns() const { return (width + side - 1) / side; }
    [[nodiscard]] std::size_t tiles() const { return columns() * ((height + side - 1) / side); }
    /// Control tiles.
    [[nodiscard]] std::size_t count() const {
        return group > 0 ? (tiles() + group - 1) / group : 0;
    }
    /// Of all control tiles; those at the border of the picture are as large as the others.
    [[nodiscard]] std::size_t pixels() const { return count() * side * side; }
    [[nodiscard]] std::size_t bytes() const { return pixels() * sizeof(ControlPixel); }
    /// Control tile `i` among all tiles.
    [[nodiscard]] std::size_t tile(std::size_t i) const {
        return clr_control_tile(static_cast<uint>(i), static_cast<uint>(group),
                                static_cast<uint>(tiles()));
    }
};

/// Calls visit(pixel, x, y) for the pixels of control tile `i` that lie in the rows
/// [first_row, end_row) of the picture; `pixel` counts those of all control tiles.
template <typename Visit>
void for_each_control_pixel(const ControlLayout &layout, std::size_t i, std::size_t first_row,
                            std::size_t end_row, Visit visit) {
    const std::size_t left = layout.tile(i) % layout.columns() * layout.side;
    const std::size_t top = layout.tile(i) / layout.columns() * layout.side;
    const std::size_t right = std::min(left + layout.side, layout.width);
    for (std::size_t y = std::max(top, first_row); y < std::min(top + layout.side, end_row); ++y)
        for (std::size_t x = left; x < right; ++x)
            visit((i * layout.side + y - top) * layout.side + x - left, x, y);
}

/// A group for which the control tiles are enough for a figure, and otherwise a hundredth of the
/// work.
std::size_t choose_control_group(const ControlLayout &layout);

/// The variance of the pixels over what it were if their samples were independent.
struct VarianceFactor {
    double value = 1;
    double error = 0; ///< standard error of `value`
};

/// What the control tiles know: `pixels` of all of them, tile by tile, and the picture's own means
/// there, R, G and B of each pixel.
struct ControlSums {
    ControlLayout layout;
    std::span<const ControlPixel> pixels;
    std::span<const double> means;
    int film_exponent = 0;
};

/// The factor by which the mean over the picture of variance / (value^2 + .01) is right: in all
/// control tiles the squared differences of both renderings, so weighted, over what the scatter of
/// the samples makes expect. 1 where there is no noise. `variance`: of `image`, the picture, were
/// the samples independent.
VarianceFactor variance_factor(const ControlSums &control, const Image &image,
                               const Image &variance);

/// The mean over pixels and colour channels of variance / (value^2 + .01): the expected relMSE of
/// `image` by its noise; what is systematically wrong is not part of it. Values of infinite
/// variance (of pixels whose sums were clamped) do not count, unless all are.
double mean_relative_variance(const Image &image, const Image &variance);

} // namespace clrender
