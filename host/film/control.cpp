#include "control.h"

#include "film_sums.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tbb/parallel_for.h>
#include <vector>

namespace clrender {

namespace {

/// Pixels of control tiles: as many for a figure to a tenth, where some pixels are noisier than
/// others; and the share of all pixels where that is more.
constexpr std::size_t least_pixels = 2048;
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

/// A value that is known to a quarter is its own; one that is not is too bright where its error is
/// large, and would weigh it too lightly.
double relative_variance(const Image &image, const Image &variance, std::size_t x, std::size_t y,
                         std::size_t channel) {
    constexpr double known = 1.0 / 16;
    const std::size_t i =
        (y * static_cast<std::size_t>(image.width) + x) * static_cast<std::size_t>(image.channels) +
        channel;
    const double value = double{image.f32[i]}, square = double{variance.f32[i]};
    const bool is_known = square < known * value * value;
    return square * weight_of(is_known ? value : mean_around(image, x, y, channel));
}

/// Squared differences in a control tile, and what scatter makes expect of them.
struct Squares {
    double measured = 0, expected = 0;
};

Squares squares_of_tile(const ControlLayout &layout, std::size_t tile, const ControlPixel *pixels,
                        const Image &image, const FilmUnits &units) {
    Squares sum;
    const std::size_t left = tile % layout.columns() * layout.side;
    const std::size_t top = tile / layout.columns() * layout.side;
    for (std::size_t y = 0; y < std::min(layout.side, layout.height - top); ++y)
        for (std::size_t x = 0; x < std::min(layout.side, layout.width - left); ++x) {
            const ControlPixel &pixel = pixels[y * layout.side + x];
            for (std::size_t c = 0; c < 3; ++c) {
                const std::size_t channel = std::min(c, colour_channels(image) - 1);
                const double weight = weight_of(mean_around(image, left + x, top + y, channel));
                const double difference = units.difference(pixel, static_cast<int>(c));
                sum.measured += weight * difference * difference;
                sum.expected += weight * units.scatter(pixel, static_cast<int>(c));
            }
        }
    return sum;
}

} // namespace

std::size_t choose_control_group(const ControlLayout &layout) {
    const std::size_t least_tiles =
        (least_pixels + layout.side * layout.side - 1) / (layout.side * layout.side);
    const std::size_t wanted = std::max(least_tiles, layout.tiles() / tiles_per_control_tile);
    return std::max<std::size_t>((layout.tiles() + wanted - 1) / wanted, 1);
}

VarianceFactor variance_factor(const ControlLayout &layout, std::span<const ControlPixel> pixels,
                               const Image &image, int film_exponent) {
    const FilmUnits units(film_exponent);
    std::vector<Squares> tiles;
    Squares sum;
    for (std::size_t i = 0; i < layout.count(); ++i) {
        const std::size_t tile =
            clr_control_tile(static_cast<uint>(i), static_cast<uint>(layout.group),
                             static_cast<uint>(layout.tiles()));
        const ControlPixel *first = pixels.data() + i * layout.side * layout.side;
        tiles.push_back(squares_of_tile(layout, tile, first, image, units));
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
    tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
        for (std::size_t x = 0; x < width; ++x)
            for (std::size_t c = 0; c < colours; ++c)
                rows[y] += relative_variance(image, variance, x, y, c);
    });
    return std::accumulate(rows.begin(), rows.end(), 0.0) /
           static_cast<double>(std::max<std::size_t>(width * height, 1) * colours);
}

} // namespace clrender
