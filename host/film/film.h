#pragma once
/// From the device's sums to pictures.

#include "scene/scene.h"
#include "shared/launch_data.h"

#include <span>

namespace clrender {

/// The weighted mean of each pixel, in the channels of `format`; a pixel without samples is black.
Image film_mean(std::span<const FilmPixel> pixels, int width, int height, PixelFormat format);

/// The estimated variance of each mean: of a ratio of sums, to first order (Cochran, "Sampling
/// Techniques", 1977, section 6.4). Per channel for RGB and alpha; for the other formats the bound
/// that holds however R, G and B are correlated.
Image film_variance(std::span<const FilmPixel> pixels, int width, int height, PixelFormat format);

} // namespace clrender
