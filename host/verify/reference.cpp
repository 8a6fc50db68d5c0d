#include "reference.h"

#include "image/color.h"
#include "image/layers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fmt/core.h>
#include <numeric>
#include <utility>

namespace clrender::verify {

namespace {

/// Whether every value is one of 16 bits: then the file, or what it was made from, was rounded so.
bool is_half(const Image &image) {
    constexpr std::uint32_t bits_below_half = 0x1FFF;
    return std::all_of(image.f32.begin(), image.f32.end(), [](float value) {
        return (std::bit_cast<std::uint32_t>(value) & bits_below_half) == 0;
    });
}

/// The variances of linear sRGB, at most, from those of X, Y and Z, however the three correlate.
void bound_in_srgb(Image &variance) {
    const glm::dmat3 matrix = glm::inverse(srgb_to_xyz());
    const auto channels = static_cast<std::size_t>(variance.channels);
    for (std::size_t i = 0; i + 2 < variance.f32.size(); i += channels) {
        const glm::dvec3 deviation = {std::sqrt(double{variance.f32[i]}),
                                      std::sqrt(double{variance.f32[i + 1]}),
                                      std::sqrt(double{variance.f32[i + 2]})};
        for (int row = 0; row < 3; ++row) {
            double sum = 0;
            for (int column = 0; column < 3; ++column)
                sum += std::abs(matrix[column][row]) * deviation[column];
            variance.f32[i + static_cast<std::size_t>(row)] = static_cast<float>(sum * sum);
        }
    }
    variance.color_space = ColorSpace::srgb;
}

void check_variance(const Image &variance, const Image &image, const std::string &path) {
    if (colour_channels(variance) != colour_channels(image))
        throw InputError({path, 0}, "the layer variance has other channels than the picture");
    if (const std::string place = nonfinite_pixel(variance); !place.empty())
        throw InputError({path, 0}, "the variance of pixel " + place +
                                        " is not known, expected a reference of more samples");
    if (std::any_of(variance.f32.begin(), variance.f32.end(), [](float v) { return v < 0; }))
        throw InputError({path, 0}, "a variance is negative");
}

} // namespace

int colour_channels(const Image &image) {
    return image.channels <= 2 ? 1 : 3;
}

std::string nonfinite_pixel(const Image &image) {
    const auto channels = static_cast<std::size_t>(image.channels);
    const auto colours = static_cast<std::size_t>(colour_channels(image));
    for (std::size_t i = 0; i < image.f32.size(); ++i)
        if (i % channels < colours && !std::isfinite(image.f32[i])) {
            const std::size_t pixel = i / channels, width = static_cast<std::size_t>(image.width);
            return fmt::format("({}, {})", pixel % width, pixel / width);
        }
    return {};
}

Reference read_reference(const std::string &path) {
    Reference reference;
    reference.image = read_image(path);
    if (reference.image.type != PixelType::f32)
        throw InputError({path, 0}, "8 bits a channel, expected an EXR file");
    if (const std::string place = nonfinite_pixel(reference.image); !place.empty())
        throw InputError({path, 0}, "pixel " + place + " is NaN or infinite");
    if (is_half(reference.image))
        reference.rounding = std::exp2(-11) / std::sqrt(3.0);

    reference.variance = read_exr_layer(path, "variance");
    if (reference.variance) {
        check_variance(*reference.variance, reference.image, path);
        if (reference.variance->color_space == ColorSpace::xyz)
            bound_in_srgb(*reference.variance);
    }
    if (const auto samples = read_exr_layer(path, "samples"); samples && reference.variance)
        reference.samples = std::accumulate(samples->f32.begin(), samples->f32.end(), 0.0) /
                            static_cast<double>(samples->f32.size());
    return reference;
}

} // namespace clrender::verify
