#include "control.h"

#include "film_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tbb/parallel_for.h>
#include <vector>

namespace clrender {

namespace {

/// Pixels of control tiles: as many for a figure to a tenth, where a few tiles make most of the
/// noise; and the share of all tiles where that is more.
constexpr std::size_t least_pixels = 8192;
constexpr std::size_t tiles_per_control_tile = 100;

/// As relMSE: keeps dark pixels from ruling the relative error.
constexpr double epsilon = 0.01;

std::size_t colour_channels(const Image &image) {
    return image.channels <= 2 ? 1 : 3;
}

/// The weight of a squared error in a value.
double weight_of(double value) {
    return 1 / (value * value + epsilon);
}

/// The mean of the pixels around one, which its own noise does not touch.
double mean_around(const Image &image, std::size_t x, std::size_t y, std::size_t channel) {
    const auto width = static_cast<std::size_t>(image.width);
    const auto height = static_cast<std::size_t>(image.height);
    const auto channels = static_cast<std::size_t>(image.channels);
    double sum = 0, count = 0;
    for (std::size_t j = y - std::min<std::size_t>(y, 1); j < std::min(y + 2, height); ++j)
        for (std::size_t i = x - std::min<std::size_t>(x, 1); i < std::min(x + 2, width); ++i)
            if (i != x || j != y) {
                sum += double{image.f32[(j * width + i) * channels + channel]};
                ++count;
            }
    return count > 0 ? sum / count : double{image.f32[channel]};
}

/// The weight of the squared error of a value. One that is known to a sixteenth is its own; one
/// that is not is too bright where its error seems large, and would weigh it too lightly: in its
/// place stands what its neighbours say, as far as its error allows.
double weight_at(const Image &image, const Image &variance, std::size_t x, std::size_t y,
                 std::size_t channel) {
    constexpr double known = 1.0 / 256;
    constexpr double most_errors = 2;
    const std::size_t i =
        (y * static_cast<std::size_t>(image.width) + x) * static_cast<std::size_t>(image.channels) +
        channel;
    const double value = double{image.f32[i]}, square = double{variance.f32[i]};
    if (square * weight_of(value) < known)
        return weight_of(value);
    const double reach = most_errors * std::sqrt(square);
    return weight_of(std::clamp(mean_around(image, x, y, channel), value - reach, value + reach));
}

/// Squared differences in a control tile, and what scatter makes expect of them.
struct Squares {
    double measured = 0, expected = 0;
};

/// Adds a control pixel in the channel `channel`, whose mean in the picture is `mean`. With this
/// mean, each rendering's sum of w (L - mean) has the error that it adds to the picture's.
void add_squares(Squares &sum, const ControlPixel &pixel, const FilmUnits &units, int channel,
                 double mean, double weight) {
    double difference = 0;
    for (const MeasuredPixel &rendering : pixel.rendering) {
        const PixelSums sums(rendering.sums, units);
        difference = sums.colour(channel) - mean * sums.weight() - difference;
        sum.expected += weight * variance_of_sum(PixelMoments(rendering.moments, units),
                                                 sums.weight(), channel, mean);
    }
    sum.measured += weight * difference * difference;
}

Squares squares_of_tile(const ControlSums &control, std::size_t tile, const Image &image,
                        const Image &variance) {
    Squares sum;
    const FilmUnits units(control.film_exponent);
    for_each_control_pixel(control.layout, tile, 0, control.layout.height,
                           [&](std::size_t pixel, std::size_t x, std::size_t y) {
                               for (std::size_t c = 0; c < 3; ++c)
                                   add_squares(sum, control.pixels[pixel], units,
                                               static_cast<int>(c), control.means[3 * pixel + c],
                                               weight_at(image, variance, x, y,
                                                         std::min(c, colour_channels(image) - 1)));
                           });
    return sum;
}

} // namespace

std::size_t choose_control_group(const ControlLayout &layout) {
    const std::size_t least_tiles =
        (least_pixels + layout.side * layout.side - 1) / (layout.side * layout.side);
    const std::size_t wanted = std::max(least_tiles, layout.tiles() / tiles_per_control_tile);
    return std::max<std::size_t>((layout.tiles() + wanted - 1) / wanted, 1);
}

VarianceFactor variance_factor(const ControlSums &control, const Image &image,
                               const Image &variance) {
    std::vector<Squares> tiles;
    Squares sum;
    for (std::size_t i = 0; i < control.layout.count(); ++i) {
        tiles.push_back(squares_of_tile(control, i, image, variance));
        sum.measured += tiles.back().measured;
        sum.expected += tiles.back().expected;
    }
    VarianceFactor factor;
    if (!(sum.expected > 0))
        return factor;
    factor.value = sum.measured / sum.expected;
    // Of a ratio of sums over tiles, to first order.
    double squares = 0;
    for (const Squares &tile : tiles) {
        const double rest = tile.measured - factor.value * tile.expected;
        squares += rest * rest;
    }
    const auto count = static_cast<double>(tiles.size());
    factor.error = std::sqrt(squares * count / std::max(count - 1, 1.0)) / sum.expected;
    return factor;
}

double mean_relative_variance(const Image &image, const Image &variance) {
    const std::size_t colours = colour_channels(image);
    const auto width = static_cast<std::size_t>(image.width);
    const auto height = static_cast<std::size_t>(image.height);
    // Row by row, so that the sum does not depend on the threads.
    std::vector<double> rows(height, 0.0);
    std::vector<std::size_t> known(height, 0);
    tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
        for (std::size_t x = 0; x < width; ++x)
            for (std::size_t c = 0; c < colours; ++c) {
                const double value =
                    variance.f32[(y * width + x) * static_cast<std::size_t>(image.channels) + c];
                if (std::isinf(value))
                    continue;
                rows[y] += weight_at(image, variance, x, y, c) * value;
                ++known[y];
            }
    });
    const std::size_t values = std::accumulate(known.begin(), known.end(), std::size_t{0});
    if (values == 0 && !variance.f32.empty())
        return std::numeric_limits<double>::infinity();
    return std::accumulate(rows.begin(), rows.end(), 0.0) /
           static_cast<double>(std::max<std::size_t>(values, 1));
}

} // namespace clrender
