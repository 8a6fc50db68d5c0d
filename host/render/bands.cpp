#include "bands.h"

#include <algorithm>

namespace clrender {

namespace {

/// Bands begin at even rows of tiles, so that they hold whole rows of every colour.
constexpr std::size_t row_unit = 2;

std::size_t divide_up(std::size_t value, std::size_t unit) {
    return (value + unit - 1) / unit;
}

Band band_of(const PictureTiles &tiles, std::size_t first, std::size_t end) {
    Band band;
    band.tiles = {tiles.columns(), first, end};
    band.first_row = first * tiles.side - std::min(2 * tiles.border, first * tiles.side);
    band.end_row = std::min(end * tiles.side + tiles.border, tiles.height);
    return band;
}

} // namespace

std::size_t band_bytes(const PictureTiles &tiles, const Band &band) {
    return (band.end_row - band.first_row) * tiles.row_bytes() +
           (band.tiles.end_row - band.tiles.first_row) * tiles.columns() * sizeof(ItemCounters);
}

std::vector<Band> cut_into_bands(const PictureTiles &tiles, std::size_t bytes,
                                 std::size_t tile_rows) {
    const std::size_t rows = tiles.rows();
    if (tile_rows == 0) {
        if (band_bytes(tiles, band_of(tiles, 0, rows)) <= bytes)
            return {band_of(tiles, 0, rows)};
        const std::size_t pixel_row = tiles.row_bytes();
        const std::size_t tile_row =
            pixel_row * tiles.side + tiles.columns() * sizeof(ItemCounters);
        const std::size_t borders = 3 * tiles.border * pixel_row;
        const std::size_t most =
            (bytes - std::min(bytes, borders)) / tile_row / row_unit * row_unit;
        const std::size_t count = divide_up(rows, std::max(most, row_unit));
        tile_rows = divide_up(rows, count);
    }
    tile_rows = divide_up(tile_rows, row_unit) * row_unit;
    std::vector<Band> bands;
    for (std::size_t first = 0; first < rows; first += tile_rows)
        bands.push_back(band_of(tiles, first, std::min(first + tile_rows, rows)));
    return bands;
}

} // namespace clrender
