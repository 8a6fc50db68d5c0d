#pragma once
/// From the device's sums to pictures.

#include "scene/scene.h"
#include "shared/launch_data.h"

#include <span>

namespace clrender {

/// The mean of each pixel, in the channels of `format`. `samples[i]` is how many pixel i has; a
/// pixel without any is black.
Image film_mean(std::span<const FilmPixel> pixels, std::span<const int> samples, int width,
                int height, PixelFormat format);

/// The estimated variance of each mean, from the sums of squares: per channel for RGB; for the
/// other formats the bound that holds however R, G and B are correlated. 0 for alpha, and where
/// there are fewer than two samples.
Image film_variance(std::span<const FilmPixel> pixels, std::span<const int> samples, int width,
                    int height, PixelFormat format);

} // namespace clrender
