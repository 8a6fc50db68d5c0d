#pragma once
/// Linear colour spaces of pictures: from whatever primaries to those of BT.709 (sRGB).

#include "image.h"

#include <glm/glm.hpp>

#include <optional>

namespace clrender {

/// CIE xy of three primaries and of white.
struct Chromaticities {
    glm::dvec2 red{0.64, 0.33}, green{0.30, 0.60}, blue{0.15, 0.06}, white{0.3127, 0.3290};
};

/// Linear sRGB to CIE XYZ (columns are the primaries), as Mitsuba has it.
glm::dmat3 srgb_to_xyz();

/// From linear RGB of other primaries to linear sRGB, by way of CIE XYZ. The white is not adapted:
/// colours stay the same to an eye that does not adapt, as in Mitsuba. The identity where the
/// primaries are sRGB's up to 1e-4; nothing where they make no colour space.
std::optional<glm::dmat3> to_srgb(const Chromaticities &from);

/// Multiplies the colours of a picture with three of them (and maybe alpha, which stays).
void transform_colors(Image &image, const glm::dmat3 &matrix);

/// The picture in linear sRGB.
Image in_linear_srgb(Image image);

} // namespace clrender
