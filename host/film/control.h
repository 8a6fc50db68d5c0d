#pragma once
/// What the control tiles of a render tell of its error.

#include "image/image.h"
#include "shared/control_tile.h"

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
    [[nodiscard]] std::size_t bytes() const { return count() * side * side * sizeof(ControlPixel); }
};

/// A group for which the control tiles are enough for a figure, and otherwise a hundredth of the
/// work.
std::size_t choose_control_group(const ControlLayout &layout);

/// The variance of the pixels over what it were if their samples were independent.
struct VarianceFactor {
    double value = 1;
    double error = 0; ///< standard error of `value`
};

/// The factor by which the mean over the picture of variance / (value^2 + .01) is right: in all
/// control tiles the squared differences of both renderings, so weighted, over what the scatter of
/// the samples makes expect. The value of a pixel is taken as the median of those around it. 1
/// where there is no noise. `pixels`: those of all control tiles, tile by tile; `image`: the
/// picture.
VarianceFactor variance_factor(const ControlLayout &layout, std::span<const ControlPixel> pixels,
                               const Image &image, int film_exponent);

/// The mean over pixels and colour channels of variance / (value^2 + .01): the expected relMSE of
/// `image` by its noise; what is systematically wrong is not part of it. Values are medians as
/// above.
double mean_relative_variance(const Image &image, const Image &variance);

} // namespace clrender
