#include "control.h"

#include "film_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tbb/parallel_for.h>
#include <vector>

namespace clrender {

namespace {

/// Pixels of control tiles: as many for a figure to a tenth, where some pixels are noisier than
/// others; and the share of all pixels where that is more.
constexpr std::size_t least_pixels = 1024;
constexpr std::size_t tiles_per_control_tile = 100;

/// As relMSE: keeps dark pixels from ruling the relative error.
constexpr double epsilon = 0.01;

std::size_t colour_channels(const Image &image) {
    return image.channels <= 2 ? 1 : 3;
}

/// The weight of a squared error in the value of a pixel: by the median of the pixels around it,
/// since a value that is too bright by its own noise would weigh it too lightly.
double weight_of(const Image &image, std::size_t x, std::size_t y, std::size_t channel) {
    const auto width = static_cast<std::size_t>(image.width);
    const auto height = static_cast<std::size_t>(image.height);
    const auto channels = static_cast<std::size_t>(image.channels);
    channel = std::min(channel, colour_channels(image) - 1);
    std::array<float, 9> around{};
    std::size_t count = 0;
    for (std::size_t j = y - std::min<std::size_t>(y, 1); j < std::min(y + 2, height); ++j)
        for (std::size_t i = x - std::min<std::size_t>(x, 1); i < std::min(x + 2, width); ++i)
            around[count++] = image.f32[(j * width + i) * channels + channel];
    const auto middle = around.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(around.begin(), middle, around.begin() + static_cast<std::ptrdiff_t>(count));
    const double value = *middle;
    return 1 / (value * value + epsilon);
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
                const double weight = weight_of(image, left + x, top + y, c);
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
    const auto channels = static_cast<std::size_t>(image.channels);
    const std::size_t colours = colour_channels(image);
    const auto width = static_cast<std::size_t>(image.width);
    const auto height = static_cast<std::size_t>(image.height);
    // Row by row, so that the sum does not depend on the threads.
    std::vector<double> rows(height, 0.0);
    tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
        for (std::size_t x = 0; x < width; ++x)
            for (std::size_t c = 0; c < colours; ++c)
                rows[y] += weight_of(image, x, y, c) *
                           double{variance.f32[(y * width + x) * channels + c]};
    });
    return std::accumulate(rows.begin(), rows.end(), 0.0) /
           static_cast<double>(std::max<std::size_t>(width * height, 1) * colours);
}

} // namespace clrender
