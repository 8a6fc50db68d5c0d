#include "texels.h"

#include <Imath/half.h>

#include <algorithm>

namespace clrender {

namespace {

double decode_byte(std::uint8_t byte, bool raw) {
    const double value = byte / 255.0;
    return raw ? value : srgb_decode(value);
}

} // namespace

double round_to_half(double value) {
    constexpr double largest = 65504;
    const double clamped = std::clamp(value, -largest, largest);
    return double{static_cast<float>(Imath::half(static_cast<float>(clamped)))};
}

std::array<double, 256> decode_bytes(TexelFormat format) {
    std::array<double, 256> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = decode_byte(static_cast<std::uint8_t>(i), format.raw);
        if (format.half)
            values[i] = round_to_half(values[i]);
    }
    return values;
}

glm::dvec3 texel_color(const Image &image, std::size_t at, TexelFormat format) {
    const auto channels = static_cast<std::size_t>(image.channels);
    glm::dvec3 color;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = at * channels + (channels >= 3 ? k : 0);
        double value = image.type == PixelType::f32 ? double{image.f32[i]}
                                                    : decode_byte(image.u8[i], format.raw);
        if (format.half)
            value = round_to_half(value);
        color[static_cast<int>(k)] = value;
    }
    return color;
}

} // namespace clrender
