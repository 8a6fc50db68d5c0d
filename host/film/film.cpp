#include "film.h"

#include "../image/color.h"

#include <algorithm>
#include <array>
#include <cmath>

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

/// Kahan's sum: what was lost is still to be taken off.
double total(const FilmPixel &pixel, int entry) {
    return static_cast<double>(pixel.sum[entry]) - static_cast<double>(pixel.lost[entry]);
}

/// Entries of FilmPixel::sum.
constexpr int entry_alpha = 3;
constexpr int entry_weight = 4;
constexpr int entry_weight2 = 5;

/// Weighted mean of a channel: R, G, B, alpha.
double mean(const FilmPixel &pixel, int channel) {
    const double weight = total(pixel, entry_weight);
    return weight != 0 ? total(pixel, channel) / weight : 0;
}

/// Standard deviation of that mean: the sum of w^2 (L - mean)^2, multiplied out.
double deviation(const FilmPixel &pixel, int channel) {
    const double weight = total(pixel, entry_weight);
    if (weight == 0)
        return 0;
    const double m = mean(pixel, channel);
    const double square = static_cast<double>(pixel.moment[channel]);
    const double cross =
        channel == entry_alpha ? square : static_cast<double>(pixel.moment[4 + channel]);
    const double weight2 = total(pixel, entry_weight2);
    const double sum = square - 2 * m * cross + m * m * weight2;
    // The usual correction of n / (n - 1), with the number of samples that count.
    const double n = weight * weight / weight2;
    return n > 1 ? std::sqrt(std::max(sum, 0.0) * n / (n - 1)) / std::abs(weight) : 0;
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
            image.f32.push_back(static_cast<float>(glm::dot(row, c)));
        if (alpha_channel)
            image.f32.push_back(static_cast<float>(alpha(i)));
    }
    return image;
}

} // namespace

Image film_mean(std::span<const FilmPixel> pixels, int width, int height, PixelFormat format) {
    Image image = make_image(
        width, height, colour_rows(format), has_alpha(format),
        [&](std::size_t i) {
            return Rgb{mean(pixels[i], 0), mean(pixels[i], 1), mean(pixels[i], 2)};
        },
        [&](std::size_t i) { return mean(pixels[i], entry_alpha); });
    image.color_space = color_space(format);
    return image;
}

Image film_variance(std::span<const FilmPixel> pixels, int width, int height, PixelFormat format) {
    Image image = make_image(
        width, height, colour_rows(format), has_alpha(format),
        [&](std::size_t i) {
            return Rgb{deviation(pixels[i], 0), deviation(pixels[i], 1), deviation(pixels[i], 2)};
        },
        [&](std::size_t i) { return deviation(pixels[i], entry_alpha); });
    for (float &value : image.f32)
        value *= value;
    image.color_space = color_space(format);
    return image;
}

} // namespace clrender
