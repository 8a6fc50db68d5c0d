#pragma once
/// From the numbers of a picture to linear colours: the one place that decodes the texels of
/// textures and environment maps.

#include "image.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>

namespace clrender {

/// How the numbers of a picture are to be taken.
struct TexelFormat {
    bool raw = false;  ///< 8 bits are linear, not sRGB-encoded (floats always are)
    bool half = false; ///< colours are kept in half precision
};

/// The nearest number of half precision; the largest one for what is larger.
double round_to_half(double value);

/// The linear values of the 256 bytes.
std::array<double, 256> decode_bytes(TexelFormat format);

/// The colour of pixel `at`; grey pictures give the same for all channels.
glm::dvec3 texel_color(const Image &image, std::size_t at, TexelFormat format = {});

} // namespace clrender
