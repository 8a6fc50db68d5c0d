#include "film.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace clrender {

namespace {

/// Rows of the matrix from linear sRGB to the colour channels of a format (Rec. 709 to CIE XYZ).
std::vector<Rgb> colour_rows(PixelFormat format) {
    const Rgb x{0.412453, 0.357580, 0.180423};
    const Rgb y{0.212671, 0.715160, 0.072169};
    const Rgb z{0.019334, 0.119193, 0.950227};
    switch (format) {
    case PixelFormat::luminance:
    case PixelFormat::luminance_alpha:
        return {y};
    case PixelFormat::xyz:
    case PixelFormat::xyza:
        return {x, y, z};
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

/// Kahan's sum: what was lost is still to be taken off.
double total(const float (&sum)[4], const float (&lost)[4], int channel) {
    return static_cast<double>(sum[channel]) - static_cast<double>(lost[channel]);
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

Image film_mean(std::span<const FilmPixel> pixels, std::span<const int> samples, int width,
                int height, PixelFormat format) {
    const auto mean = [&](std::size_t i, int channel) {
        return total(pixels[i].sum, pixels[i].sum_lost, channel) / std::max(samples[i], 1);
    };
    return make_image(
        width, height, colour_rows(format), has_alpha(format),
        [&](std::size_t i) {
            return Rgb{mean(i, 0), mean(i, 1), mean(i, 2)};
        },
        [&](std::size_t i) { return mean(i, 3); });
}

Image film_variance(std::span<const FilmPixel> pixels, std::span<const int> samples, int width,
                    int height, PixelFormat format) {
    const auto deviation = [&](std::size_t i, int channel) {
        if (samples[i] < 2)
            return 0.0;
        const double n = samples[i];
        const double mean = total(pixels[i].sum, pixels[i].sum_lost, channel) / n;
        const double square = total(pixels[i].square, pixels[i].square_lost, channel) / n;
        return std::sqrt(std::max(square - mean * mean, 0.0) / (n - 1));
    };
    std::vector<Rgb> rows = colour_rows(format);
    Image image = make_image(
        width, height, rows, has_alpha(format),
        [&](std::size_t i) {
            return Rgb{deviation(i, 0), deviation(i, 1), deviation(i, 2)};
        },
        [](std::size_t) { return 0.0; });
    for (float &value : image.f32)
        value *= value;
    return image;
}

} // namespace clrender
