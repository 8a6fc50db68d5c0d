#pragma once
/// The device's exact sums as numbers, and their addition.

#include "shared/launch_data.h"

namespace clrender {

/// The sums of one pixel; colours in the scene's own unit, given the exponent of the film's.
/// Channels: R, G, B, alpha.
class PixelSums {
public:
    PixelSums(const FilmPixel &pixel, int film_exponent)
        : pixel_(pixel), exponent_(film_exponent) {}

    /// Of the filter's weight times the channel.
    [[nodiscard]] double colour(int channel) const;
    /// Of the squared distances from the mean (FilmPixel::scatter).
    [[nodiscard]] double scatter(int channel) const;
    /// Of the filter's weight.
    [[nodiscard]] double weight() const;
    [[nodiscard]] double samples() const { return pixel_.samples; }

private:
    const FilmPixel &pixel_;
    int exponent_;
};

/// Adds the sums of other samples of the same pixel, exactly: sums of parts are the same bits
/// in any order.
void add_pixel(FilmPixel &sum, const FilmPixel &part);

} // namespace clrender
