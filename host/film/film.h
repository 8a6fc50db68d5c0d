#pragma once
/// From the device's sums to pictures.

#include "scene/scene.h"
#include "shared/launch_data.h"

#include <span>
#include <vector>

namespace clrender {

/// The sums of a picture, row by row.
struct Film {
    int width = 0, height = 0;
    int exponent = 0; ///< FrameData::film_exponent
    std::vector<FilmPixel> pixels;
    std::vector<FilmMoments> moments; ///< empty where the variance is not wanted
};

/// What the colours of a picture in `format` are.
ColorSpace color_space(PixelFormat format);

/// The weighted mean of each pixel, in the channels of `format`; a pixel without samples is black.
Image film_mean(const Film &film, PixelFormat format);

/// The samples that lie in each pixel, in one channel.
Image film_samples(const Film &film);

/// The estimated variance of each mean, were the samples of a pixel independent: of a ratio of
/// sums, to first order (Cochran, "Sampling Techniques", 1977, section 6.4), from the scatter about
/// it of all samples that reach the pixel. Infinite where fewer than two lie in it, or where a sum
/// was clamped. Per channel for RGB and alpha; for the other formats the bound that holds however
/// R, G and B are correlated.
Image film_variance(const Film &film, PixelFormat format);

} // namespace clrender
