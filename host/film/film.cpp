#include "film.h"

#include "../image/color.h"
#include "film_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace clrender {

namespace {

/// Rows of the matrix from linear sRGB to the colour channels of a format (Rec. 709 to CIE XYZ).
std::vector<Rgb> colour_rows(PixelFormat format) {
    const glm::dmat3 rows = glm::transpose(srgb_to_xyz());
    switch (format) {
    case PixelFormat::luminance:
    case PixelFormat::luminance_alpha:
        return {rows[1]};
    case PixelFormat::xyz:
    case PixelFormat::xyza:
        return {rows[0], rows[1], rows[2]};
    case PixelFormat::rgb:
    case PixelFormat::rgba:
        break;
    }
    return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
}

ColorSpace color_space(PixelFormat format) {
    return format == PixelFormat::xyz || format == PixelFormat::xyza ? ColorSpace::xyz
                                                                     : ColorSpace::srgb;
}

bool has_alpha(PixelFormat format) {
    return format == PixelFormat::luminance_alpha || format == PixelFormat::rgba ||
           format == PixelFormat::xyza;
}

/// The channels of a pixel: R, G, B, alpha.
using Channels = std::array<double, 4>;
constexpr std::size_t alpha = 3;

Channels mean(const PixelSums &sums) {
    const double weight = sums.weight();
    Channels mean{};
    for (int c = 0; weight != 0 && c < 4; ++c)
        mean[static_cast<std::size_t>(c)] = sums.colour(c) / weight;
    return mean;
}

/// Of each pixel the sum of squared distances of its samples from their mean; infinite where there
/// are too few samples to tell.
std::vector<Channels> scatter(const Film &film) {
    std::vector<Channels> all;
    all.reserve(film.pixels.size());
    const FilmUnits units(film.exponent);
    for (const FilmPixel &pixel : film.pixels) {
        const PixelSums sums(pixel, units);
        Channels &scatter = all.emplace_back();
        for (int c = 0; c < 4; ++c)
            scatter[static_cast<std::size_t>(c)] =
                sums.samples() > 1 ? sums.scatter(c) : std::numeric_limits<double>::infinity();
    }
    return all;
}

/// Each value replaced by the sum of those around it along one axis, times `spread`. `count` values
/// lie along the axis, `step` apart, in each of the `lines` that begin `line_step` apart.
std::vector<Channels> spread_along(const std::vector<Channels> &values,
                                   const std::vector<double> &spread, std::size_t count,
                                   std::size_t step, std::size_t lines, std::size_t line_step) {
    const std::size_t border = spread.size() / 2;
    std::vector<Channels> result(values.size(), Channels{});
    for (std::size_t line = 0; line < lines; ++line)
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = i - std::min(i, border); j < std::min(i + border + 1, count); ++j)
                for (std::size_t c = 0; c < 4; ++c)
                    result[line * line_step + i * step][c] +=
                        spread[border + j - i] * values[line * line_step + j * step][c];
    return result;
}

/// The sum of the channels times their coefficients; those that do not count may be infinite.
double combine(const Rgb &coefficients, const Rgb &colour) {
    double sum = 0;
    for (int c = 0; c < 3; ++c)
        if (coefficients[c] != 0)
            sum += coefficients[c] * colour[c];
    return sum;
}

/// An image whose pixel i is rows * colour(i), with alpha(i) behind where the format has it.
template <typename Colour, typename Alpha>
Image make_image(int width, int height, const std::vector<Rgb> &rows, bool alpha_channel,
                 Colour colour, Alpha alpha) {
    Image image;
    image.width = width;
    image.height = height;
    image.channels = static_cast<int>(rows.size()) + (alpha_channel ? 1 : 0);
    const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    image.f32.reserve(count * static_cast<std::size_t>(image.channels));
    for (std::size_t i = 0; i < count; ++i) {
        const Rgb c = colour(i);
        for (const Rgb &row : rows)
            image.f32.push_back(static_cast<float>(combine(row, c)));
        if (alpha_channel)
            image.f32.push_back(static_cast<float>(alpha(i)));
    }
    return image;
}

} // namespace

Image film_mean(const Film &film, PixelFormat format) {
    std::vector<Channels> means;
    means.reserve(film.pixels.size());
    const FilmUnits units(film.exponent);
    for (const FilmPixel &pixel : film.pixels)
        means.push_back(mean(PixelSums(pixel, units)));
    Image image = make_image(
        film.width, film.height, colour_rows(format), has_alpha(format),
        [&](std::size_t i) {
            return Rgb{means[i][0], means[i][1], means[i][2]};
        },
        [&](std::size_t i) { return means[i][alpha]; });
    image.color_space = color_space(format);
    return image;
}

Image film_samples(const Film &film) {
    Image image;
    image.width = film.width;
    image.height = film.height;
    image.channels = 1;
    for (const FilmPixel &pixel : film.pixels)
        image.f32.push_back(static_cast<float>(pixel.samples));
    return image;
}

Image film_variance(const Film &film, PixelFormat format) {
    const auto width = static_cast<std::size_t>(film.width);
    const auto height = static_cast<std::size_t>(film.height);
    std::vector<Channels> values = scatter(film);
    values = spread_along(values, film.spread, width, 1, height, width);
    values = spread_along(values, film.spread, height, width, width, 1);
    const FilmUnits units(film.exponent);
    const auto deviation = [&](std::size_t i, std::size_t c) {
        const double weight = PixelSums(film.pixels[i], units).weight();
        return weight != 0 ? std::sqrt(values[i][c]) / std::abs(weight)
                           : std::numeric_limits<double>::infinity();
    };
    Image image = make_image(
        film.width, film.height, colour_rows(format), has_alpha(format),
        [&](std::size_t i) {
            return Rgb{deviation(i, 0), deviation(i, 1), deviation(i, 2)};
        },
        [&](std::size_t i) { return deviation(i, alpha); });
    for (float &value : image.f32)
        value *= value;
    image.color_space = color_space(format);
    return image;
}

} // namespace clrender
