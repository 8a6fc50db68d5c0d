#pragma once
/// The device's exact sums as numbers, and their addition.

#include "shared/launch_data.h"

namespace clrender {

/// What the lowest bits of a film's sums are worth, given FrameData::film_exponent.
struct FilmUnits {
    double colour, alpha, colour_scatter, alpha_scatter;

    explicit FilmUnits(int film_exponent);
};

/// The sums of one pixel. Channels: R, G, B, alpha.
class PixelSums {
public:
    PixelSums(const FilmPixel &pixel, const FilmUnits &units) : pixel_(pixel), units_(units) {}

    /// Of the filter's weight times the channel.
    [[nodiscard]] double colour(int channel) const;
    /// Of the squared distances from the mean (FilmPixel::scatter).
    [[nodiscard]] double scatter(int channel) const;
    /// Of the filter's weight.
    [[nodiscard]] double weight() const;
    [[nodiscard]] double samples() const { return pixel_.samples; }

private:
    const FilmPixel &pixel_;
    const FilmUnits &units_;
};

/// Adds the sums of other samples of the same pixel, exactly: sums of parts are the same bits
/// in any order.
void add_pixel(FilmPixel &sum, const FilmPixel &part);

} // namespace clrender
