#pragma once
/// The device's exact sums as numbers, and their addition.

#include "shared/control_tile.h"
#include "shared/launch_data.h"

namespace clrender {

/// What the lowest bits of a film's sums are worth, given FrameData::film_exponent.
struct FilmUnits {
    double colour, alpha, colour_first, alpha_first, colour_second, alpha_second;

    explicit FilmUnits(int film_exponent);
};

/// The sums of one pixel. Channels: R, G, B, alpha.
class PixelSums {
public:
    PixelSums(const FilmPixel &pixel, const FilmUnits &units) : pixel_(pixel), units_(units) {}

    /// Of the filter's weight times the channel.
    [[nodiscard]] double colour(int channel) const;
    /// Of the filter's weight.
    [[nodiscard]] double weight() const;
    /// The weighted mean of the channel; 0 where there is no weight.
    [[nodiscard]] double mean(int channel) const;
    [[nodiscard]] double samples() const { return pixel_.samples; }

private:
    const FilmPixel &pixel_;
    const FilmUnits &units_;
};

/// The moments of one pixel.
class PixelMoments {
public:
    PixelMoments(const FilmMoments &moments, const FilmUnits &units)
        : moments_(moments), units_(units) {}

    /// Of the squared weight.
    [[nodiscard]] double weight() const;
    /// Of the squared weight times the squared distance of the channel from `mean`; not negative.
    [[nodiscard]] double scatter(int channel, double mean) const;

private:
    const FilmMoments &moments_;
    const FilmUnits &units_;
};

/// The variance that independent samples would give to the sum of w (L - m) in a channel, m being
/// the mean of the pixel, which samples with the sum of weights `weight` and these moments are part
/// of.
double variance_of_sum(const PixelMoments &moments, double weight, int channel, double mean);

/// Adds the sums of other samples of the same pixel, exactly: sums of parts are the same bits
/// in any order.
void add_pixel(FilmPixel &sum, const FilmPixel &part);
void add_moments(FilmMoments &sum, const FilmMoments &part);

} // namespace clrender
