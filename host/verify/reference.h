#pragma once
/// The picture that a render is tested against, with what its file tells of its noise.

#include "image/image.h"

#include <optional>
#include <string>

namespace clrender::verify {

struct Reference {
    Image image;                   ///< f32: grey or linear sRGB, with or without alpha
    std::optional<Image> variance; ///< of each value of `image`; none: taken as exact
    double samples = 0;            ///< a pixel; 0: not known
    double rounding = 0;           ///< relative standard deviation of the format's rounding
};

/// Reads an EXR file; its layers `variance` and `samples`, as --aov writes them, where it has them.
/// Throws InputError, also for pixels that are not finite.
Reference read_reference(const std::string &path);

/// Colour channels of a picture: 1 or 3.
int colour_channels(const Image &image);

/// The first pixel whose colour is not finite, as "(x, y)", or "".
std::string nonfinite_pixel(const Image &image);

} // namespace clrender::verify
