#include "color.h"

#include <algorithm>
#include <cmath>

namespace clrender {

namespace {

/// RGB to XYZ, scaled so that white has Y = 1 (SMPTE RP 177). No number is finite where the
/// primaries lie on a line or the white has no luminance.
glm::dmat3 rgb_to_xyz(const Chromaticities &c) {
    const auto xyz = [](const glm::dvec2 &xy) { return glm::dvec3(xy, 1 - xy.x - xy.y); };
    const glm::dmat3 primaries(xyz(c.red), xyz(c.green), xyz(c.blue));
    const glm::dvec3 scale = glm::inverse(primaries) * (xyz(c.white) / c.white.y);
    return {primaries[0] * scale.r, primaries[1] * scale.g, primaries[2] * scale.b};
}

bool is_invertible(const glm::dmat3 &matrix) {
    constexpr double least = 1e-9;
    constexpr double most = 1e9;
    const double determinant = std::abs(glm::determinant(matrix));
    return determinant > least && determinant < most;
}

} // namespace

glm::dmat3 srgb_to_xyz() {
    return {{0.412453, 0.212671, 0.019334},
            {0.357580, 0.715160, 0.119193},
            {0.180423, 0.072169, 0.950227}};
}

std::optional<glm::dmat3> to_srgb(const Chromaticities &from) {
    constexpr double tolerance = 1e-4;
    const Chromaticities srgb;
    const auto is_near = [&](const glm::dvec2 &a, const glm::dvec2 &b) {
        return glm::length(a - b) <= tolerance;
    };
    if (is_near(from.red, srgb.red) && is_near(from.green, srgb.green) &&
        is_near(from.blue, srgb.blue) && is_near(from.white, srgb.white))
        return glm::dmat3(1);
    const glm::dmat3 to_xyz = rgb_to_xyz(from);
    if (!is_invertible(to_xyz))
        return std::nullopt;
    return glm::inverse(rgb_to_xyz(srgb)) * to_xyz;
}

void transform_colors(Image &image, const glm::dmat3 &matrix) {
    if (image.channels < 3 || image.type != PixelType::f32)
        return;
    const auto channels = static_cast<std::size_t>(image.channels);
    for (std::size_t i = 0; i + channels <= image.f32.size(); i += channels) {
        const glm::dvec3 color =
            matrix * glm::dvec3(image.f32[i], image.f32[i + 1], image.f32[i + 2]);
        for (std::size_t c = 0; c < 3; ++c)
            image.f32[i + c] = static_cast<float>(color[static_cast<int>(c)]);
    }
}

Image in_linear_srgb(Image image) {
    if (image.color_space == ColorSpace::xyz)
        transform_colors(image, glm::inverse(srgb_to_xyz()));
    image.color_space = ColorSpace::srgb;
    return image;
}

} // namespace clrender
