#pragma once
/// How far a picture is from a reference.

#include "image/image.h"

#include <array>
#include <cstdint>

namespace clrender {

/// All values are over the colour channels (alpha is left out) of all pixels, in linear light;
/// a is the picture, r the reference.
struct ImageDifference {
    double mse = 0;              ///< mean((a - r)^2)
    double rel_mse = 0;          ///< mean((a - r)^2 / (r^2 + 0.01))
    double rel_mse_trimmed = 0;  ///< the same without the worst 0.1% of the pixels
    double bias = 0;             ///< mean(a - r)
    double largest = 0;          ///< max |a - r|
    std::array<int, 2> where{};  ///< pixel of the largest difference, from the top left corner
    std::uint64_t nonfinite = 0; ///< pixels with a NaN or an infinity in a or r, left out above
};

/// Values of 8-bit images are decoded from sRGB. Throws InputError naming `a_name` if the sizes
/// or the numbers of colour channels differ.
ImageDifference compare_images(const Image &a, const Image &reference, const std::string &a_name);

} // namespace clrender
