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

bool has_alpha(PixelFormat format) {
    return format == PixelFormat::luminance_alpha || format == PixelFormat::rgba ||
           format == PixelFormat::xyza;
}

/// The channels of a pixel: R, G, B, alpha.
using Channels = std::array<double, 4>;
constexpr std::size_t alpha = 3;

Channels mean(const PixelSums &sums) {
    Channels mean{};
    for (int c = 0; c < 4; ++c)
        mean[static_cast<std::size_t>(c)] = sums.mean(c);
    return mean;
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

ColorSpace color_space(PixelFormat format) {
    return format == PixelFormat::xyz || format == PixelFormat::xyza ? ColorSpace::xyz
                                                                     : ColorSpace::srgb;
}

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
    const FilmUnits units(film.exponent);
    const auto deviation = [&](std::size_t i, int c) {
        const PixelSums sums(film.pixels[i], units);
        const double weight = sums.weight();
        if (weight == 0 || sums.samples() < 2 || film.pixels[i].clamped != 0)
            return std::numeric_limits<double>::infinity();
        const PixelMoments moments(film.moments[i], units);
        return std::sqrt(variance_of_sum(moments, weight, c, sums.mean(c))) / std::abs(weight);
    };
    Image image = make_image(
        film.width, film.height, colour_rows(format), has_alpha(format),
        [&](std::size_t i) {
            return Rgb{deviation(i, 0), deviation(i, 1), deviation(i, 2)};
        },
        [&](std::size_t i) { return deviation(i, static_cast<int>(alpha)); });
    for (float &value : image.f32)
        value *= value;
    image.color_space = color_space(format);
    return image;
}

} // namespace clrender
