#pragma once
/// Large pictures are rendered in bands, one after the other, so that the device holds the sums of
/// one band only.

#include "launch_plan.h"
#include "shared/launch_data.h"

#include <cstddef>
#include <vector>

namespace clrender {

/// The tiles of a picture, one for each work-item.
struct PictureTiles {
    std::size_t width = 0, height = 0; ///< of the picture, pixels
    std::size_t side = 1;              ///< of a tile, pixels
    std::size_t border = 0;            ///< pixels beyond its tile that a sample reaches
    bool measured = false;             ///< the variance is wanted: the film has MeasuredPixels

    [[nodiscard]] std::size_t columns() const { return (width + side - 1) / side; }
    [[nodiscard]] std::size_t rows() const { return (height + side - 1) / side; }
    [[nodiscard]] std::size_t pixels() const { return width * height; }
    /// Of a row of the device's film.
    [[nodiscard]] std::size_t row_bytes() const {
        return width * (measured ? sizeof(MeasuredPixel) : sizeof(FilmPixel));
    }
};

/// Whole rows of tiles, and the rows of pixels [first_row, end_row) whose sums are needed for them:
/// those that their samples reach, and above them as many again, from which the variances of the
/// rows at the border come.
struct Band {
    TileRows tiles;
    std::size_t first_row = 0, end_row = 0;
};

/// Device memory of a band: the sums of its pixels, and a record for each of its tiles.
std::size_t band_bytes(const PictureTiles &tiles, const Band &band);

/// Bands of about equal heights, of at most `bytes` each as far as two rows of tiles fit into that;
/// of `tile_rows` rows of tiles (made even) where that is not 0. From top to bottom, at least one.
std::vector<Band> cut_into_bands(const PictureTiles &tiles, std::size_t bytes,
                                 std::size_t tile_rows = 0);

} // namespace clrender
